"""`python -m examples.feed_axis`: builds the system, runs it in a master, checks the how-to."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Final

import numpy as np
import typer

from stickslip.errors import CommandError
from stickslip.parameters import quantity
from stickslip_design.axis import AxisError, axis_of, example, read_axis
from stickslip_native.compiler import CompilerError
from stickslip_verification.report.svg import as_svg

from . import masters, plots, study
from .runs import Run, columns, creep, hold
from .system import Move, build_all

MOST_ROWS: Final = 20_000
"""Rows of run.csv, about; of a longer run every n-th is written."""
DOCUMENT: Final = Path("docs/feed-axis.md")

app = typer.Typer(
    help="A feed axis, closed loop: a servo drive moves the stick-slip block.",
    rich_markup_mode=None,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Master(StrEnum):
    """Who steps the two FMUs."""

    FMPY = "fmpy"
    ECOS = "ecos"
    LIBCOSIM = "libcosim"


AxisFile = Annotated[
    Path | None,
    typer.Argument(metavar="[AXIS.toml]", help="An axis with a drive; default: of the how-to."),
]
Folder = Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to.")]
Native = Annotated[bool, typer.Option("--native", help="Compile the table for this machine.")]
OUTPUT: Final = Path("build/feed_axis")


@app.command()
def build(file: AxisFile = None, native: Native = False, output: Folder = OUTPUT) -> None:
    """Build StickSlip.fmu, ServoDrive.fmu and FeedAxis.ssp."""
    axis = axis_of(example()) if file is None else read_axis(file)
    print(build_all(output, axis, Move(axis.demand.feeds[0]), native=native))


@app.command()
def run(
    file: AxisFile = None,
    master: Annotated[Master, typer.Option(help="Who steps the FMUs.")] = Master.FMPY,
    feed: Annotated[str, typer.Option(help="Commanded speed.")] = "0.5 mm/s",
    distance: Annotated[str, typer.Option(help="Way of a move, then a hold; 0: no end.")] = "0",
    stop_time: Annotated[str, typer.Option(metavar="TIME", help="End of the run.")] = "2",
    native: Native = False,
    output: Folder = OUTPUT,
) -> None:
    """Run the axis in a master; print what was found, write FeedAxis.ssp, run.csv and run.svg."""
    axis = axis_of(example()) if file is None else read_axis(file)
    move = Move(
        quantity(feed, "m/s", "--feed"),
        axis.demand.acceleration or 0.1,
        quantity(distance, "m", "--distance"),
    )
    ssp = build_all(output, axis, move, native=native)
    end = quantity(stop_time, "s", "--stop-time")
    found = run_in(master, ssp, end, axis.drive.T_s if axis.drive else 0.0)
    with plots.styled():
        if move.distance:
            hunts, expected = hold(found), study.expected_hunting(axis)
            tell("comes to rest", hunts.stops)
            tell("jump [µm]", 1e6 * hunts.jump, expected and 1e6 * expected.jump)
            tell("period [s]", hunts.period, expected and expected.period)
            page = plots.holding(found, axis.F_s, 0.5 * end, 0.5 * end)
        else:
            creeps, cycle = creep(found), study.expected_jump(axis, move.feed)
            tell("jump [µm]", 1e6 * creeps.jump, cycle and 1e6 * cycle.way)
            tell("period [ms]", 1e3 * creeps.period, cycle and 1e3 * cycle.period)
            tell("mean following error [µm]", 1e6 * creeps.error)
            shown = min(0.2, 0.5 * end)
            page = plots.creeping(found, move.feed, axis.F_s, end - shown, shown)
        (output / "run.svg").write_text(as_svg(page, Title="A feed axis"), encoding="utf-8")
    rows = np.column_stack(list(found.values()))[:: -(-len(found["time"]) // MOST_ROWS)]
    np.savetxt(output / "run.csv", rows, "%.9g", ",", header=",".join(found), comments="")
    print(f"{ssp}, {output / 'run.csv'}, {output / 'run.svg'}")


def tell(what: str, found: float, computed: float | None = None) -> None:
    """Print a line of the results."""
    print(f"{what}: {found:.4g}" + (f", design tool {computed:.4g}" if computed else ""))


@app.command("study")
def make_study(
    check: Annotated[bool, typer.Option("--check", help="Write nothing, compare only.")] = False,
    variant: Annotated[
        list[str] | None, typer.Option(help="With --check: this row alone; may be repeated.")
    ] = None,
) -> None:
    """Make the tables and pictures of docs/feed-axis.md anew, or check that they still hold."""
    names = variant or list(study.VARIANTS)
    if unknown := set(names) - study.VARIANTS.keys():
        raise CommandError(f"--variant: there is no {unknown.pop()!r} in {list(study.VARIANTS)}")
    with tempfile.TemporaryDirectory(prefix="feed-axis-") as folder:
        build_all(Path(folder), study.BASE, Move(5e-4))
        if not check:
            study.write_document(DOCUMENT, Path(folder))
        elif wrong := list(study.check_document(DOCUMENT, Path(folder), names)):
            sys.exit("\n".join(wrong))


def run_in(master: str, ssp: Path, stop_time: float, step: float) -> Run:
    """Run an SSP file in a process of its own, in the master of this name.

    Raises
    ------
    CommandError
        If the master fails; the message ends with what the FMU said, else with the last line.
    """
    with tempfile.TemporaryDirectory(prefix="feed-axis-") as folder:
        table = Path(folder) / "run.csv"
        words = [masters.__file__, master, ssp, repr(stop_time), repr(step), table]
        command = [sys.executable, "-I", *map(str, words)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        lines = done.stderr.strip().splitlines() or ["no reason given"]
        if done.returncode != 0:
            own = [line for line in lines if line.startswith(("StickSlip", "ServoDrive"))]
            raise CommandError(f"{master} failed: {(own or lines[-1:])[0]}")
        # Not every master stops where an FMU fails; what the FMU says is for the person.
        print(done.stderr, end="", file=sys.stderr)
        return columns(np.genfromtxt(table, delimiter=",", skip_header=1, ndmin=2))


def main() -> None:
    """Run the command; the exit code is 0 for done, 1 for a failed check, 2 for wrong use."""
    try:
        app(prog_name="python -m examples.feed_axis")
    except (AxisError, CommandError, CompilerError, ValueError) as error:
        print(f"feed_axis: {error}", file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
