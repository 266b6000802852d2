"""Progress for people who wait, and interruption where an exception must not fly.

Everything goes to standard error, only on a terminal, and only once a second has passed.
"""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING, Self, TextIO

if TYPE_CHECKING:
    from rich.progress import Progress

_PATIENCE = 1.0
"""Seconds that pass before progress is shown."""


class Meter:
    """A progress bar that appears after a second of work in its `with` block."""

    def __init__(self, description: str) -> None:
        # What an engine writes on standard error is caught while it runs; this is the terminal.
        self._bar = _bar(sys.stderr) if sys.stderr.isatty() else None
        if self._bar is not None:
            self._task = self._bar.add_task(description, total=None)
            self._timer = threading.Timer(_PATIENCE, self._bar.start)
            self._timer.daemon = True

    def __enter__(self) -> Self:
        if self._bar is not None:
            self._timer.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._timer.cancel()
            # It may be about to show the bar.
            self._timer.join()
            self._bar.stop()

    def advance(self, done: float, total: float | None, description: str | None = None) -> None:
        """Say how far the work is: `done` of `total` if known, and on what it is now."""
        if self._bar is not None:
            self._bar.update(self._task, completed=done, total=total, description=description)


def _bar(terminal: TextIO) -> "Progress":
    from rich.console import Console
    from rich.progress import Progress, TimeElapsedColumn

    return Progress(
        *Progress.get_default_columns(),
        TimeElapsedColumn(),
        console=Console(file=terminal),
        transient=True,
        redirect_stdout=False,
        redirect_stderr=False,
    )


@contextmanager
def deferred_interrupt() -> Iterator[Callable[[], bool]]:
    """Turn Ctrl-C, or a SIGTERM, into a question, and raise it when the block has ended.

    An FMU whose code is Python would take a `KeyboardInterrupt` for a failure of its own. It yields
    a function that is true once Ctrl-C has been pressed. A second Ctrl-C is not deferred.
    """
    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    pressed = threading.Event()
    before = {each: signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)}

    def note(signum: int, frame: FrameType | None) -> None:
        pressed.set()
        signal.signal(signum, before[signal.Signals(signum)])

    for each in before:
        signal.signal(each, note)
    try:
        yield pressed.is_set
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
        if pressed.is_set():
            raise KeyboardInterrupt
