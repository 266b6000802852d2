"""`stickslip simulate`: one run of the FMU or of the reference, as a table, a file, a plot."""

from pathlib import Path
from typing import Literal

from stickslip.commands.expanded import command
from stickslip.commands.shared import console, say
from stickslip.errors import CommandError
from stickslip.parameters import Parameters


@command
def simulate(
    *,
    p: Parameters,
    engine: Literal["fmu", "reference"] = "fmu",
    fmu: Path | None = None,
    start_time: str = "0",
    stop_time: str = "10",
    output_interval: str | None = None,
    most_slips: int | None = None,
    output_file: Path | None = None,
    plot: Path | None = None,
    json: bool = False,
) -> None:
    """Simulate one run and print its cycle beside the exact and the simplified one."""
    from stickslip.files import check_drawable, check_writable
    from stickslip.library import simulate as simulated
    from stickslip.progress import meter

    if fmu is not None and engine != "fmu":
        raise CommandError("--fmu goes with --engine fmu only")
    # What cannot be written is refused before the run, not after it.
    if output_file is not None:
        check_writable(output_file, "--output-file")
    if plot is not None:
        check_drawable(plot, "--plot")
        check_writable(plot, "--plot")
    with meter("Simulating") as advance:
        run = simulated(
            p,
            stop_time,
            engine=fmu or ("reference" if engine == "reference" else "block"),
            start_time=start_time,
            output_interval=output_interval,
            most_slips=most_slips,
            drawn=plot is not None,
            progress=advance,
        )
    for note in run.notes:
        say(f"warning: {note}")
    if output_file is not None:
        run.write_csv(output_file, "--output-file")
    if plot is not None:
        from stickslip.show.plot import write_plot

        write_plot(run, plot, "--plot")
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
