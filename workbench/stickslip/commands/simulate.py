"""`stickslip simulate`: one run of the FMU or of the reference, as a table, a file, a plot."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from stickslip.commands.expanded import command
from stickslip.commands.shared import console, say
from stickslip.errors import CommandError
from stickslip.parameters import Parameters


class Engine(StrEnum):
    """What simulates."""

    FMU = "fmu"
    REFERENCE = "reference"


@command
def simulate(
    p: Parameters,
    engine: Annotated[Engine, typer.Option(help="The FMU, or the SciPy reference.")] = Engine.FMU,
    fmu: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="The FMU to simulate; default: one built for this run."),
    ] = None,
    start_time: Annotated[str, typer.Option(metavar="TIME", help="First time [s].")] = "0",
    stop_time: Annotated[str, typer.Option(metavar="TIME", help="Last time [s].")] = "10",
    output_interval: Annotated[
        str | None,
        typer.Option(
            metavar="TIME",
            help="Distance of the samples [s]; default 0.01, doubled until 1000 are enough, "
            "or halved until a --plot is smooth.",
        ),
    ] = None,
    most_slips: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="N",
            help="Slips that a run may have; default 1000000, of the reference 10000.",
            show_default=False,
        ),
    ] = None,
    output_file: Annotated[
        Path | None,
        typer.Option(metavar="FILE.csv", help="Write the samples of every output here."),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw position and force here: .png, .svg or .pdf."),
    ] = None,
    json: Annotated[
        bool, typer.Option("--json", help="Print the figures of the cycle as JSON, SI.")
    ] = False,
) -> None:
    """Simulate one run and print its cycle beside the exact and the simplified one."""
    from stickslip.files import check_writable
    from stickslip.library import simulate as simulated
    from stickslip.progress import Meter
    from stickslip.show.plot import check_format

    if fmu is not None and engine is not Engine.FMU:
        raise CommandError("--fmu goes with --engine fmu only")
    # What cannot be written is refused before the run, not after it.
    if output_file is not None:
        check_writable(output_file, "--output-file")
    if plot is not None:
        check_format(plot, "--plot")
        check_writable(plot, "--plot")
    with Meter("Simulating") as meter:
        run = simulated(
            p,
            stop_time,
            engine=fmu or ("reference" if engine is Engine.REFERENCE else "block"),
            start_time=start_time,
            output_interval=output_interval,
            most_slips=most_slips,
            drawn=plot is not None,
            progress=meter.advance,
        )
    for note in run.notes:
        say(f"warning: {note}")
    if output_file is not None:
        run.write_csv(output_file, "--output-file")
    if plot is not None:
        run.write_plot(plot, "--plot")
        if run.hidden_events:
            say(
                "warning: more than two events between two samples; the plot shows points only: "
                "choose a shorter --output-interval"
            )
    if json:
        print(run.to_json())
    else:
        console().print(run.table())
    files = [str(file) for file in (output_file, plot) if file is not None]
    if files:
        say("written: " + ", ".join(files)) if json else print("written:", ", ".join(files))
