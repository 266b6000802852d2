"""The process that holds the FMUs of a sweep: `python -m stickslip_design.sweeps.child FOLDER`.

It reads frames from standard input and answers on standard output, whose descriptors it takes away
from the FMUs first: what they print goes nowhere. It ends when it is told that all is done. Where
the process that asks is killed, it ends as well, and removes `FOLDER`, that of the unpacked FMUs.

On Linux the FMUs are in a fork of it, so that after a crash the next one starts at once; SIGTERM
ends the fork alone. Elsewhere a crash ends this process.

A frame is its length, 8 bytes, and its content. The first one is the pickled job with the folders
of its FMUs, each further one the float64 values of some runs, and an empty one says that all is
done. The answers are `READY` or `FAILED` with a reason. To each frame of runs they are `TAKEN`,
then for each run `RESULT` with its float64 values or `FAILED` with the reason. `ENDED` with an exit
code tells that a fork ended; `READY` follows for the next one.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import shutil
import signal
import struct
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO, Final

import numpy as np

from stickslip_verification import FmuError

from .job import Job
from .runner import Runner

READY: Final = b"+"
TAKEN: Final = b">"
RESULT: Final = b"="
FAILED: Final = b"!"
ENDED: Final = b"."
"""First byte of an answer."""

_PERIOD: Final = 0.5
"""Seconds between two looks for the process that asks."""

_LENGTH: Final = struct.Struct("<Q")


def send(stream: BinaryIO, content: bytes) -> None:
    """Write a frame."""
    stream.write(_LENGTH.pack(len(content)) + content)
    stream.flush()


def receive(stream: BinaryIO) -> bytes | None:
    """Read a frame and nothing behind it; None where the stream ends before its end."""
    head = _read(stream, _LENGTH.size)
    return None if head is None else _read(stream, _LENGTH.unpack(head)[0])


def _read(stream: BinaryIO, size: int) -> bytes | None:
    parts = []
    while size:
        part = stream.read(size)
        if not part:
            return None
        parts.append(part)
        size -= len(part)
    return b"".join(parts)


def main() -> None:
    """Do what is asked until the input ends."""
    # Unbuffered: what a fork has not read is there for the next one.
    asked, answers = os.fdopen(os.dup(0), "rb", buffering=0), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for descriptor in (0, 1):
        os.dup2(nothing, descriptor)
    # Ctrl-C is for the process that asks.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    folder = Path(sys.argv[1])
    begin = receive(asked)
    done = False
    if begin is not None:
        job, folders = pickle.loads(begin)
        with contextlib.suppress(BrokenPipeError):
            if sys.platform == "linux":
                _fork(answers, folder)
            else:
                _follow(folder)
            done = _serve(asked, answers, job, folders)
    if not done:
        # The pipes of a killed process are closed before it is seen that its children lost it.
        _leave(folder)
    # What an FMU does when its library is unloaded cannot hurt any more.
    os._exit(0)


def _serve(asked: BinaryIO, answers: BinaryIO, job: Job, folders: Sequence[Path]) -> bool:
    """Do runs until all is done; False if the process that asks has ended before."""
    try:
        runner = Runner(job, folders)
    except FmuError as error:
        send(answers, FAILED + str(error).encode())
        return True
    send(answers, READY)
    while content := receive(asked):
        send(answers, TAKEN)
        for values in np.frombuffer(content).reshape(-1, max(1, len(job.swept))):
            try:
                found = runner.run(values[: len(job.swept)])
            except FmuError as error:
                send(answers, FAILED + str(error).encode())
            else:
                send(answers, RESULT + struct.pack(f"={len(found)}d", *found))
    runner.close()
    return content is not None


def _fork(answers: BinaryIO, folder: Path) -> None:
    """Return in a fork; this process forks again where one has crashed, and ends after the last."""
    parent, own = os.getppid(), os.getpid()
    watched = {signal.SIGCHLD, signal.SIGTERM}
    signal.pthread_sigmask(signal.SIG_BLOCK, watched)
    while True:
        fork = os.fork()
        if fork == 0:
            signal.pthread_sigmask(signal.SIG_UNBLOCK, watched)
            _end_with(own)
            return
        status = None
        while status is None:
            came = signal.sigtimedwait(watched, _PERIOD)
            if came is not None and came.si_signo == signal.SIGTERM:
                os.kill(fork, signal.SIGKILL)
            ended, so = os.waitpid(fork, os.WNOHANG)
            if ended:
                status = so
            elif os.getppid() != parent:
                os.kill(fork, signal.SIGKILL)
                # Until its end it may write into the folder.
                os.waitpid(fork, 0)
                _leave(folder)
        code = os.waitstatus_to_exitcode(status)
        if os.getppid() != parent:
            _leave(folder)
        if code == 0:
            os._exit(0)
        try:
            send(answers, ENDED + str(code).encode())
        except BrokenPipeError:
            _leave(folder)


def _end_with(parent: int) -> None:
    """End this process with its parent, whatever an FMU does in it: prctl(2)."""
    import ctypes

    zero = ctypes.c_ulong(0)
    ctypes.CDLL(None).prctl(1, ctypes.c_ulong(signal.SIGKILL), zero, zero, zero)
    if os.getppid() != parent:
        os._exit(1)


def _follow(folder: Path) -> None:
    """Have this process end with its parent."""
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(_PERIOD)
        _leave(folder)

    threading.Thread(target=watch, daemon=True).start()


def _leave(folder: Path) -> None:
    """End this process after the one that asked was killed: nobody else removes the folder."""
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)


if __name__ == "__main__":
    main()
