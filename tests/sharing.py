"""What one process of a run makes, and the others take as it is."""

import fcntl
import tempfile
from collections.abc import Callable
from pathlib import Path


def made_once(name: str, make: Callable[[Path], None]) -> Path:
    root = Path(tempfile.gettempdir()) / f"shared-{name}"
    root.mkdir(exist_ok=True)
    with (root / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        ready = root / "ready"
        if not ready.exists():
            folder = Path(tempfile.mkdtemp(dir=root))
            make(folder)
            ready.write_text(str(folder), encoding="utf-8")
        return Path(ready.read_text(encoding="utf-8"))
