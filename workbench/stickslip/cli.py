"""The command `stickslip`: its commands put together, and every way that it can end.

What costs time to import is imported by the command that needs it, so that help stays quick.
"""

import io
import os
import re
import shlex
import signal
import sys
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Final

import typer
from typer.exceptions import TyperException

from stickslip.commands.build import build
from stickslip.commands.critical import critical
from stickslip.commands.design import design
from stickslip.commands.identify import identify
from stickslip.commands.map import map as map_
from stickslip.commands.names import names
from stickslip.commands.page import explore, page
from stickslip.commands.reversal import reversal
from stickslip.commands.scatter import scatter
from stickslip.commands.score import score
from stickslip.commands.shared import say
from stickslip.commands.simulate import simulate
from stickslip.commands.sweep import sweep
from stickslip.commands.verify import verify
from stickslip.errors import CommandError
from stickslip_fmu.release import VERSION

_INSTALL: Final = re.compile(r"pip install 'stickslip\[([\w-]+)\]'")


def advised(refusal: str, words: Sequence[str]) -> str:
    """Return a refusal with advice for the person who typed `words`."""
    return _INSTALL.sub(_line_of_extra, refusal) + _on_a_unit_apart(words)


def _on_a_unit_apart(words: Sequence[str]) -> str:
    """Say how to write a quantity whose unit the shell has made a word of its own."""
    from stickslip_units import spelled

    for number, unit in pairwise(words):
        if number[-1:].isdigit() and unit != "1" and spelled(unit, all_below=True) is not None:
            return f"; number and unit must be one word: {number}{unit}, or '{number} {unit}'"
    return ""


def _line_of_extra(advice: re.Match[str]) -> str:
    """Return a line that installs an extra into this Python, wherever stickslip came from."""
    from importlib import metadata

    try:
        requirements = metadata.requires("stickslip") or []
    except metadata.PackageNotFoundError:
        return advice[0]
    extra = re.compile(rf"extra == (['\"]){advice[1]}\1")
    packages = [text.partition(";")[0].strip() for text in requirements if extra.search(text)]
    return shlex.join([sys.executable, "-m", "pip", "install", *packages])


WRONG_USE = 2
INTERRUPTED = 130
INTERNAL_ERROR = 70
"""EX_SOFTWARE of sysexits.h: neither a verdict nor the person's mistake."""

SUMMARY = "Build the stick-slip FMU, simulate and explore it, verify any such FMU or curve."

app = typer.Typer(
    name="stickslip",
    help=SUMMARY,
    # Plain help takes half the time and folds well in any terminal.
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)

COMMANDS = (
    *(build, simulate, critical, identify, design, reversal, map_, scatter, sweep, explore, page),
    *(verify, names, score),
)
for command in COMMANDS:
    # Told whole: what is made of the text by itself is cut after 45 letters.
    app.command(short_help=(command.__doc__ or "").partition("\n")[0])(command)


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"stickslip {VERSION}")
        raise typer.Exit


@app.callback(help=SUMMARY)
def stickslip(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    """Take the options that stand before the command."""


def main() -> None:
    """Run the command and exit.

    The code is 0 for done, 1 for a failed check or a reader that went away, 2 for wrong use, 70
    for an internal error, 130 for interrupted.
    """
    # Who closes a stream does not want to see it; writing there must not fail.
    sys.stdout = sys.stdout or open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115, PTH123
    sys.stderr = sys.stderr or open(os.devnull, "w", encoding="utf-8")  # noqa: SIM115, PTH123
    for stream in (sys.stdout, sys.stderr):
        # A pipe or file in a code page without Greek gets a question mark, not a crash.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    # A request to end cleans up behind itself, as Ctrl-C does.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    code = _exit_code()
    try:
        sys.stdout.flush()
    except OSError as error:
        if not isinstance(error, BrokenPipeError):
            say(f"cannot write the output: {error.strerror or error}")
        # Python flushes once more on its way out, and would complain of the closed pipe.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = code or 1
    sys.exit(code)


def _exit_code() -> int:
    try:
        code = app(prog_name="stickslip", standalone_mode=False)
    except CommandError as error:
        say(advised(str(error), sys.argv[1:]))
        return WRONG_USE
    except TyperException as error:
        text = error.format_message().replace("Value error, ", "").rstrip(".")
        context = getattr(error, "ctx", None)
        of = context.command_path if context else "stickslip"
        say(f"{advised(text, sys.argv[1:])}; see {of} --help")
        return WRONG_USE
    except KeyboardInterrupt:
        code = INTERRUPTED
    except BrokenPipeError:
        return 1
    except OSError as error:
        say(f"{error.filename or ''}: {error.strerror or error}".lstrip(": "))
        return WRONG_USE
    except Exception as error:
        say(f"internal error, please report it: {type(error).__name__}: {error}")
        return INTERNAL_ERROR
    if code == INTERRUPTED:
        say("interrupted")
    return code if isinstance(code, int) else 0
