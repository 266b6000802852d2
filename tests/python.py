"""Programs in processes of their own, such as this Python."""

import subprocess
import sys
from typing import Any


def run(*command: object, **more: Any) -> subprocess.CompletedProcess[str]:
    words = [*map(str, command)]
    return subprocess.run(words, capture_output=True, text=True, check=False, **more)


def python(
    *arguments: object, timeout: float = 120.0, **more: Any
) -> subprocess.CompletedProcess[str]:
    done = run(sys.executable, *arguments, timeout=timeout, **more)
    assert done.returncode == 0, done.stderr[-2000:]
    return done
