"""Progress for people who wait, and interruption where an exception must not fly.

Everything goes to standard error, only on a terminal, and only once a second has passed.
"""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_PATIENCE = 1.0
"""Seconds that pass before progress is shown."""


@contextmanager
def meter(description: str) -> Iterator[Callable[..., None]]:
    """Show a progress bar once the work in the block has taken a second.

    It yields a function of how much is done, of how much if that is known (else None), and of what
    is being done, where that is not `description`.
    """
    if not sys.stderr.isatty():
        yield lambda done, total, now=None: None
        return
    from rich.console import Console
    from rich.progress import Progress, TimeElapsedColumn

    bar = Progress(
        *Progress.get_default_columns(),
        TimeElapsedColumn(),
        # What an engine writes on standard error is caught while it runs; this is the terminal.
        console=Console(file=sys.stderr),
        transient=True,
        redirect_stdout=False,
        redirect_stderr=False,
    )
    task = bar.add_task(description, total=None)
    timer = threading.Timer(_PATIENCE, bar.start)
    timer.daemon = True
    timer.start()
    try:
        yield lambda done, total, now=None: bar.update(
            task, completed=done, total=total, description=now
        )
    finally:
        timer.cancel()
        # It may be about to show the bar.
        timer.join()
        bar.stop()


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
