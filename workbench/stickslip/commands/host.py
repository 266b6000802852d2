"""`stickslip host`: a program that loads the FMU, started with the libpython that it needs."""

from collections.abc import Mapping, Sequence
from typing import Annotated

import typer

from stickslip.commands.shared import say
from stickslip.errors import CommandError

NOT_FOUND = 127
NOT_EXECUTABLE = 126
"""Exit codes for a command that cannot be started, as shells give them."""


def host(
    command: Annotated[
        list[str] | None,
        typer.Argument(metavar="-- COMMAND", show_default=False, help="What to start."),
    ] = None,
    python: Annotated[
        str | None,
        typer.Option(
            metavar="PROGRAM",
            help="Take the libpython of this interpreter; default: of the one that runs stickslip.",
        ),
    ] = None,
    show: Annotated[
        bool, typer.Option("--show", help="Print the line to type by hand; start nothing.")
    ] = False,
) -> None:
    """Start a simulator that is not Python with the libpython that the FMU needs.

    Without it the simulator says: StickSlip.so: undefined symbol: _Py_NoneStruct (or another that
    begins with Py), or only that the FMU cannot be loaded. The command's exit code and signals
    are the simulator's own. A simulator that is linked to a libpython of its own is left alone.
    """
    import os

    from stickslip.host.launch import prepare

    if not command:
        raise CommandError("give the program to start after two dashes: stickslip host -- COMMAND")
    launch = prepare(command, python, os.environ)
    if launch.own:
        say(f"{command[0]} brings {launch.own}: it is left alone, nothing is preloaded")
    if show:
        print(launch.line)
        return
    try:
        _become(launch.command, {**os.environ, **launch.changes})
    except OSError as error:
        say(f"{command[0]}: {error.strerror or error}")
        missing = isinstance(error, FileNotFoundError | NotADirectoryError)
        raise typer.Exit(NOT_FOUND if missing else NOT_EXECUTABLE) from None


def _become(command: Sequence[str], environment: Mapping[str, str]) -> None:
    """Turn this process into the command; return only where that cannot be done."""
    import os
    import signal
    import subprocess
    import sys

    if sys.platform == "win32":
        # Windows has no exec: the shell would not wait for what it starts.
        raise typer.Exit(subprocess.run(command, env=environment, check=False).returncode)
    sys.stdout.flush()
    # Python ignores these two, and what is ignored stays so in the command.
    for ignored in (signal.SIGPIPE, signal.SIGXFSZ):
        signal.signal(ignored, signal.SIG_DFL)
    os.execvpe(command[0], list(command), environment)
