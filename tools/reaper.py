"""Becomes a command that all processes begun under it fall to when their parents have ended.

``python tools/reaper.py COMMAND...``: so ``times`` in a shell counts their CPU seconds too, as of
the workers of a verdict, whose server ends after what began it. On Linux alone; elsewhere the
command runs as it is.
"""

import ctypes
import os
import sys

PR_SET_CHILD_SUBREAPER = 36

if sys.platform == "linux":
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
os.execvp(sys.argv[1], sys.argv[1:])
