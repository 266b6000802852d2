"""Runs a master as a simulator is: in a process that cannot import the project.

Called with the path of `masters.py` and its arguments.
"""

import runpy
import sys
from pathlib import Path

if __name__ == "__main__":
    runpy.run_path(str(Path(__file__).resolve().parents[1] / "barred.py"), run_name="__main__")
    sys.argv = sys.argv[1:]
    runpy.run_path(sys.argv[0], run_name="__main__")
