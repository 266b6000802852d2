"""Progress for people who wait, and interruption where an exception must not fly.

Everything goes to standard error, only on a terminal, and only once a second has passed.
"""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from rich.progress import Progress

_PATIENCE = 1.0
"""Seconds that pass before progress is shown."""


class Meter:
    """A progress bar that appears after a second of work in its `with` block."""

    def __init__(self, description: str) -> None:
        self._description = description
        # What an engine writes on standard error is caught while it runs; this is the terminal.
        self._stream = sys.stderr
        self._lock = threading.Lock()
        self._progress: Progress | None = None
        self._done: float | None = None
        self._total: float | None = None
        self._timer = threading.Timer(_PATIENCE, self._show)
        self._timer.daemon = True
        self._ended = False

    def __enter__(self) -> Self:
        if self._stream.isatty():
            self._timer.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._timer.cancel()
        with self._lock:
            self._ended = True
            if self._progress is not None:
                self._progress.stop()
                self._progress = None

    def advance(self, done: float, total: float | None, description: str | None = None) -> None:
        """Say how far the work is: `done` of `total` if known, and on what it is now."""
        with self._lock:
            self._done, self._total = done, total
            self._description = description or self._description
            if self._progress is not None:
                self._update(self._progress)

    def _show(self) -> None:
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            Progress,
            TaskProgressColumn,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        with self._lock:
            if self._ended:
                return
            self._progress = Progress(
                TextColumn("{task.description}"),
                BarColumn(),
                TaskProgressColumn("{task.percentage:3.0f} %"),
                TimeElapsedColumn() if self._total is None else TimeRemainingColumn(),
                console=Console(file=self._stream),
                transient=True,
                redirect_stdout=False,
                redirect_stderr=False,
            )
            self._progress.add_task(self._description, total=None)
            self._update(self._progress)
            self._progress.start()

    def _update(self, progress: "Progress") -> None:
        progress.update(
            progress.task_ids[0],
            description=self._description,
            completed=self._done or 0.0,
            total=self._total,
        )


@contextmanager
def deferred_interrupt() -> Iterator[Callable[[], bool]]:
    """Turn Ctrl-C, or a SIGTERM, into a question, and raise it when the block has ended.

    An FMU whose code is Python would take a `KeyboardInterrupt` for a failure of its own. A second
    Ctrl-C is not deferred.

    Yields
    ------
    Callable[[], bool]
        True once Ctrl-C has been pressed.

    Raises
    ------
    KeyboardInterrupt
        At the end of the block if Ctrl-C was pressed in it.
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
