"""`stickslip simulate`: one run of the FMU or of the reference, as a table, a file, a plot."""

import math
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from stickslip.commands.laws import read_law
from stickslip.commands.options import (
    Damping,
    ExternalForce,
    FrictionLawOrThatOfCurve,
    Gravity,
    GrowthTime,
    KineticFriction,
    LawParameter,
    Load,
    LogarithmicGrowth,
    LogarithmTime,
    Mass,
    MeasuredCurve,
    NormalForce,
    PullingVelocity,
    StartAge,
    StartExtension,
    StartPosition,
    StartVelocity,
    StaticFriction,
    Stiffness,
)
from stickslip.commands.quantities import read_experiment
from stickslip.commands.shared import COULOMB, build_for_run, console, here_on_path, say
from stickslip.errors import CommandError

if TYPE_CHECKING:
    from fmi.table import Table
    from stickslip.simulate.engines import Experiment
    from stickslip.simulate.run import Run
    from stickslip_ref import Parameters


class Engine(StrEnum):
    """What simulates."""

    FMU = "fmu"
    REFERENCE = "reference"


_MOST_SLIPS: Final = {Engine.FMU: 1_000_000, Engine.REFERENCE: 10_000}
"""Slips of a run without --most-slips: each takes less than a minute."""


def simulate(
    engine: Annotated[Engine, typer.Option(help="The FMU, or the SciPy reference.")] = Engine.FMU,
    fmu: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="The FMU to simulate; default: one built for this run."),
    ] = None,
    m: Mass = None,
    g: Gravity = None,
    k: Stiffness = None,
    c: Damping = None,
    mu_s: StaticFriction = None,
    mu_k: KineticFriction = None,
    tau_s: GrowthTime = None,
    B: LogarithmicGrowth = None,
    t_0: LogarithmTime = None,
    age_start: StartAge = None,
    x_start: StartPosition = None,
    x_dot_start: StartVelocity = None,
    z_start: StartExtension = None,
    v: PullingVelocity = None,
    load: Load = None,
    F_ext: ExternalForce = None,
    law: FrictionLawOrThatOfCurve = None,
    law_parameter: LawParameter = None,
    curve: MeasuredCurve = None,
    normal_force: NormalForce = None,
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
) -> None:
    """Simulate one run and print its cycle beside the exact and the simplified one."""
    typed = {"m": m, "g": g, "k": k, "c": c, "mu_s": mu_s, "mu_k": mu_k}
    typed |= {"tau_s": tau_s, "B": B, "t_0": t_0, "age_start": age_start}
    typed |= {"x_start": x_start, "x_dot_start": x_dot_start, "z_start": z_start}
    typed |= {"v": v, "load": load, "F_ext": F_ext}
    law, table, values = read_law(law, typed, law_parameter, curve, normal_force)
    times = read_experiment(start_time, stop_time, output_interval)
    if fmu is not None and engine is not Engine.FMU:
        raise CommandError("--fmu goes with --engine fmu only")
    _check_targets(output_file, plot)

    from stickslip.show.cycle_table import cycle_table

    # The closed forms of the cycle are those of Coulomb's law.
    parameters = _checked_parameters(values) if law == COULOMB else None
    run = _run(engine, fmu, law, table, values, times, most_slips, drawn=plot is not None)
    if output_file is not None:
        from stickslip.simulate.csv_file import write_csv

        write_csv(run.samples, output_file, "--output-file")
    if plot is not None:
        from stickslip.show.plot import write_plot

        write_plot(run, plot, "--plot")
        if run.hidden_events:
            say(
                "warning: more than two events between two samples; the plot shows points only: "
                "choose a shorter --output-interval"
            )
    console().print(cycle_table(run, parameters))
    files = [str(file) for file in (output_file, plot) if file is not None]
    if files:
        print("written:", ", ".join(files))


def _check_targets(output_file: Path | None, plot: Path | None) -> None:
    """Refuse what cannot be written before the run, not after it."""
    from stickslip.files import check_writable

    if output_file is not None:
        check_writable(output_file, "--output-file")
    if plot is not None:
        from stickslip.show.plot import check_format

        check_format(plot, "--plot")
        check_writable(plot, "--plot")


def _checked_parameters(values: dict[str, float]) -> "Parameters":
    """Refuse values that are each in range and do not go together."""
    import warnings

    from stickslip.simulate.engines import reference_parameters

    with warnings.catch_warnings():
        # The engine gives its own warnings.
        warnings.simplefilter("ignore")
        try:
            return reference_parameters(values)
        except ValueError as error:
            raise CommandError(str(error)) from error


def _check_slips(experiment: "Experiment", most: int) -> None:
    """Refuse a run that would have many more slips than anybody waits for."""
    from stickslip.simulate.engines import expected_slips

    # No slip is shorter than half a swing of the mass on its spring, so most runs are short enough.
    half_swing = math.pi * math.sqrt(experiment.parameters["m"] / experiment.parameters["k"])
    if experiment.duration / half_swing <= most:
        return
    slips = expected_slips(experiment)
    if slips is not None and slips > most:
        raise CommandError(
            f"--stop-time: the run has about {slips:.3g} slips, and {most} are allowed; shorten "
            f"it, or allow them by --most-slips {math.ceil(slips)}"
        )


def _run(
    engine: Engine,
    fmu: Path | None,
    law: str,
    table: "Table",
    values: dict[str, float],
    times: tuple[float, float, float | None],
    most_slips: int | None,
    drawn: bool,
) -> "Run":
    import tempfile

    from stickslip.progress import Meter
    from stickslip.simulate import engines

    experiment = engines.experiment(values, *times, drawn=drawn, law=law, table=table)
    _check_slips(experiment, most_slips or _MOST_SLIPS[engine])
    if engine is Engine.REFERENCE:
        with Meter("Simulating the reference"), here_on_path():
            run, notes = engines.simulate_reference(experiment)
    else:
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            file = fmu or build_for_run(Path(folder), law)
            with Meter("Simulating the FMU") as meter:
                meter.advance(0.0, experiment.duration)
                run, notes = engines.simulate_fmu(experiment, file, meter.advance)
    for note in notes:
        say(f"warning: {note}")
    return run
