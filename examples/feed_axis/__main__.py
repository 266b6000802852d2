"""`python -m examples.feed_axis`: builds the system of an axis, runs it in a master, draws it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Final

import matplotlib.pyplot as plt
import pandas as pd
import typer

from stickslip.parameters import quantity
from stickslip.systems import Move, start_values, write_system
from stickslip_design.axis import Axis, AxisError, axis_file_of, example, read_axis_file
from stickslip_fmu.packer import build as build_block
from stickslip_native.compiler import CompilerError
from stickslip_native.packer import build as build_native
from stickslip_verification.report.svg import BLUE, GREY, ORANGE, STYLE

from .masters import MASTERS, MasterError, run

SHOWN: Final = 0.2
"""End of a run that is drawn [s] while the axis feeds; of a move, its second half."""


def main(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="[AXIS.toml]", help="An axis with a drive; default: the example."),
    ] = None,
    master: Annotated[
        str, typer.Option(help=f"Who steps the FMUs: {', '.join(MASTERS)}.")
    ] = "fmpy",
    feed: Annotated[str, typer.Option(help="Commanded speed.")] = "0.5 mm/s",
    distance: Annotated[str, typer.Option(help="Way of a move, then a hold; 0: no end.")] = "0",
    stop_time: Annotated[str, typer.Option(metavar="TIME", help="End of the run.")] = "2 s",
    native: Annotated[bool, typer.Option("--native", help="Compile the table in C.")] = False,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder to write to.")
    ] = Path("build/feed_axis"),
) -> None:
    """Build both FMUs and FeedAxis.ssp of an axis, run them, write run.csv and run.svg."""
    try:
        axis = axis_file_of(example()).axis() if file is None else read_axis_file(file).axis()
        speed, way = quantity(feed, "m/s", "--feed"), quantity(distance, "m", "--distance")
        ssp = build_all(
            output, axis, Move(speed, axis.demand.acceleration or 0.1, way), native=native
        )
        end = quantity(stop_time, "s", "--stop-time")
        table = output / "run.csv"
        run(master, ssp, end, axis.drive.T_s if axis.drive else 0.0, table)
    except (AxisError, CompilerError, MasterError, ValueError) as error:
        print(f"feed_axis: {error}", file=sys.stderr)
        raise typer.Exit(2) from None
    drawn = output / "run.svg"
    draw(pd.read_csv(table), 0.5 * end if way else max(end - SHOWN, 0.0), axis.F_s, drawn)
    print(f"{ssp}, {table}, {drawn}")


def build_all(folder: Path, axis: Axis, move: Move, *, native: bool = False) -> Path:
    """Write both FMUs and FeedAxis.ssp into a folder; return the path of the latter.

    A `native` table is compiled for this machine and has the name of the other one.
    """
    block = folder / "StickSlip.fmu"
    # It would be taken as it is.
    (folder / "ServoDrive.fmu").unlink(missing_ok=True)
    if native:
        build_native(block, this_machine=True)
    else:
        build_block(block)
    return write_system("drive", folder / "FeedAxis.ssp", start_values(axis, move), block)


def draw(rows: pd.DataFrame, start: float, F_s: float, target: Path) -> None:
    """Draw position, speed and spring force from a time [s] on; F_s [N] breaks the table away."""
    rows = rows[rows.time >= start]
    away = rows["drive.x_command"].iloc[0]
    with plt.rc_context(STYLE):
        page, (place, speed, force) = plt.subplots(
            3, 1, sharex=True, figsize=(7.0, 5.6), layout="constrained"
        )
        for name, colour, label in (
            ("drive.x_command", GREY, "command"),
            ("drive.x_motor", ORANGE, "motor"),
            ("table.x", BLUE, "table"),
        ):
            place.plot(rows.time, 1e6 * (rows[name] - away), color=colour, label=label)
        place.set_ylabel("position [µm]")
        place.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=3)
        speed.plot(rows.time, 1e3 * rows["table.x_dot"], color=BLUE)
        speed.set_ylabel("speed [mm/s]")
        force.plot(rows.time, rows["table.F"], color=ORANGE)
        force.axhline(F_s, color=GREY, lw=1.0, ls="--", label="break-away")
        force.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0))
        force.set_ylabel("spring force [N]")
        force.set_xlabel("time [s]")
        page.savefig(target, metadata={"Date": None})


if __name__ == "__main__":
    typer.run(main)
