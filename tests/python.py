"""Python in a process of its own."""

import subprocess
import sys
from typing import Any


def python(
    *arguments: object, timeout: float = 120.0, **more: Any
) -> subprocess.CompletedProcess[str]:
    """Run this Python to its end; it must end with exit code 0."""
    command = [sys.executable, *map(str, arguments)]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, timeout=timeout, **more
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done
