"""The command `stickslip`: options in, tables out. Everything else is in the modules it calls.

What costs time to import is imported by the command that needs it, so that help stays quick.
"""

import contextlib
import io
import os
import signal
import sys
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.exceptions import TyperException

from stickslip.errors import CommandError
from stickslip.quantities import help_text, option_name, read_experiment, read_values
from stickslip_fmu.release import VERSION

if TYPE_CHECKING:
    from rich.console import Console

    from stickslip.run import Run
    from stickslip_ref import Parameters
    from stickslip_verification import Case, Verdict

WRONG_USE = 2
INTERRUPTED = 130
INTERNAL_ERROR = 70
"""EX_SOFTWARE of sysexits.h: neither a verdict nor the person's mistake."""

DEFAULT_FMU = Path("build/StickSlip.fmu")
DEFAULT_REPORT = Path("report/report.json")

app = typer.Typer(
    name="stickslip",
    help="Build the stick-slip FMU, simulate it or the reference, and verify both.",
    # Plain help takes half the time and folds well in any terminal.
    rich_markup_mode=None,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


class Engine(StrEnum):
    """What simulates."""

    FMU = "fmu"
    REFERENCE = "reference"


def _quantity(name: str, panel: str, *spellings: str) -> Any:
    return typer.Option(
        option_name(name),
        *spellings,
        help=help_text(name),
        metavar="VALUE",
        rich_help_panel=panel,
        show_default=False,
    )


def _parameter(name: str) -> Any:
    return _quantity(name, "Parameters (a number in SI, or with a unit: 1kN/m, 0.5 N/um, 2 kg)")


def _input(name: str, *spellings: str) -> Any:
    return _quantity(name, "Inputs, held over the run (20mm/s, 5 N)", *spellings)


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"stickslip {VERSION}")
        raise typer.Exit


@app.callback()
def stickslip(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_show_version, is_eager=True, help="Show the version and exit."
        ),
    ] = False,
) -> None:
    """Build the stick-slip FMU, simulate it or the reference, and verify both."""


@app.command()
def build(
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="DIR|FILE.fmu", help="Folder or file to write."),
    ] = DEFAULT_FMU,
) -> None:
    """Build the FMU; print its path, size and SHA-256."""
    import hashlib

    fmu = _build(output, "-o")
    content = fmu.read_bytes()
    print(f"{fmu}  {len(content)} bytes  SHA-256 {hashlib.sha256(content).hexdigest()}")


@app.command()
def simulate(
    engine: Annotated[Engine, typer.Option(help="The FMU, or the SciPy reference.")] = Engine.FMU,
    fmu: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="The FMU to simulate; default: one built for this run."),
    ] = None,
    m: Annotated[str | None, _parameter("m")] = None,
    g: Annotated[str | None, _parameter("g")] = None,
    k: Annotated[str | None, _parameter("k")] = None,
    c: Annotated[str | None, _parameter("c")] = None,
    mu_s: Annotated[str | None, _parameter("mu_s")] = None,
    mu_k: Annotated[str | None, _parameter("mu_k")] = None,
    x_start: Annotated[str | None, _parameter("x_start")] = None,
    x_dot_start: Annotated[str | None, _parameter("x_dot_start")] = None,
    z_start: Annotated[str | None, _parameter("z_start")] = None,
    v: Annotated[str | None, _input("v")] = None,
    load: Annotated[str | None, _input("load")] = None,
    F_ext: Annotated[str | None, _input("F_ext", "--f-ext")] = None,
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
    values = read_values(
        {
            "m": m,
            "g": g,
            "k": k,
            "c": c,
            "mu_s": mu_s,
            "mu_k": mu_k,
            "x_start": x_start,
            "x_dot_start": x_dot_start,
            "z_start": z_start,
            "v": v,
            "load": load,
            "F_ext": F_ext,
        }
    )
    times = read_experiment(start_time, stop_time, output_interval)
    if fmu is not None and engine is not Engine.FMU:
        raise CommandError("--fmu goes with --engine fmu only")
    _check_targets(output_file, plot)

    from stickslip.cycle_table import cycle_table

    parameters = _checked_parameters(values)
    run = _run(engine, fmu, values, times, drawn=plot is not None)
    if output_file is not None:
        from stickslip.csv_file import write_csv

        write_csv(run.samples, output_file, "--output-file")
    if plot is not None:
        from stickslip.plot import write_plot

        write_plot(run, plot, "--plot")
        if run.hidden_events:
            _say(
                "warning: more than two events between two samples; the plot shows points only: "
                "choose a shorter --output-interval"
            )
    _console().print(cycle_table(run, parameters))


@app.command()
def verify(
    fmu: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="The FMU to verify; default: build/StickSlip.fmu, built anew."
        ),
    ] = None,
    cases: Annotated[
        str | None,
        typer.Option(metavar="PATTERN", help="Only the cases of this shell pattern: 'damped-*'."),
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List the cases and exit.")] = False,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="FILE.json", help="Where the report goes.")
    ] = DEFAULT_REPORT,
) -> None:
    """Compare FMU and reference with the exact solution; exit 0 if all is well, 1 if not."""
    from stickslip import verdict_table as tables
    from stickslip_verification import CaseError, load_cases

    try:
        chosen = load_cases(cases)
    except CaseError as error:
        raise CommandError(str(error)) from error
    if list_:
        _console().print(tables.case_table(chosen))
        return
    verdict = _verdict(fmu, chosen, output)
    console = _console()
    console.print(tables.verdict_table(verdict, console.width))
    print(output)
    if not verdict.passed:
        raise typer.Exit(1)


@app.command()
def prove(
    fmu: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="The FMU to prove; default: build/StickSlip.fmu, built anew."
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Names the random sets.")] = 1,
    fraction: Annotated[
        float, typer.Option(help="Share of the full sets, above 0 and at most 1.")
    ] = 1.0,
) -> None:
    """Hold FMU and reference against random sets; exit 0 if every statement holds, 1 if not."""
    from stickslip.progress import Meter, deferred_interrupt
    from stickslip.proof_table import proof_table
    from stickslip_verification import FmuError
    from stickslip_verification import prove as prove_all

    if not 0.0 < fraction <= 1.0:
        raise CommandError(f"--fraction {fraction!r}: must be above 0 and at most 1")
    if fmu is None:
        fmu = _build(DEFAULT_FMU, "--fmu")
    with Meter("Proving") as meter, deferred_interrupt() as interrupted:

        def show(what: str, done: int, total: int) -> None:
            if interrupted():
                raise KeyboardInterrupt
            meter.advance(done, total or None, what)

        try:
            # What the FMU warns of belongs to the draws; here it would cut the progress.
            with contextlib.redirect_stderr(io.StringIO()):
                results = prove_all(fmu, seed, fraction, show)
        except FmuError as error:
            raise CommandError(str(error)) from error
    _console().print(proof_table(results))
    if not all(each.passed for each in results):
        raise typer.Exit(1)


def main() -> None:
    """Run the command and exit.

    The code is 0 for done, 1 for a failed check or a reader that went away, 2 for wrong use, 70
    for an internal error, 130 for interrupted.
    """
    for stream in (sys.stdout, sys.stderr):
        # A pipe or file in a code page without Greek gets a question mark, not a crash.
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    # A request to end cleans up behind itself, as Ctrl-C does.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    code = _exit_code()
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        # Python flushes once more on its way out, and would complain of the closed pipe.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = code or 1
    sys.exit(code)


def _exit_code() -> int:
    try:
        code = app(prog_name="stickslip", standalone_mode=False)
    except CommandError as error:
        _say(str(error))
        return WRONG_USE
    except TyperException as error:
        _say(f"{error.format_message().rstrip('.')}; see stickslip --help")
        return WRONG_USE
    except KeyboardInterrupt:
        code = INTERRUPTED
    except BrokenPipeError:
        return 1
    except OSError as error:
        _say(f"{error.filename or ''}: {error.strerror or error}".lstrip(": "))
        return WRONG_USE
    except Exception as error:
        _say(f"internal error, please report it: {type(error).__name__}: {error}")
        return INTERNAL_ERROR
    if code == INTERRUPTED:
        _say("interrupted")
    return code if isinstance(code, int) else 0


def _say(text: str) -> None:
    """Tell the person something that is not the result: one line on standard error."""
    print(f"stickslip: {' '.join(text.split())}", file=sys.stderr)


def _console() -> "Console":
    from rich.console import Console

    # A pipe has no width of its own, and a table for a program or a log should not be folded.
    width = None if sys.stdout.isatty() else 200
    return Console(width=width, markup=False, highlight=False)


def _build(target: Path, option: str) -> Path:
    from stickslip.files import check_writable, make_folder
    from stickslip.progress import Meter

    if target.suffix == ".fmu":
        make_folder(target.parent, option)
        check_writable(target, option)
    else:
        make_folder(target, option)
    from stickslip_fmu.packer import build as build_fmu

    with Meter("Building the FMU"):
        try:
            return build_fmu(target)
        except OSError as error:
            reason = error.strerror or str(error)
            raise CommandError(f"{option} {target}: cannot write the FMU: {reason}") from error
        except ValueError as error:
            raise CommandError(str(error)) from error


def _check_targets(output_file: Path | None, plot: Path | None) -> None:
    """Refuse what cannot be written before the run, not after it."""
    from stickslip.files import check_writable

    if output_file is not None:
        check_writable(output_file, "--output-file")
    if plot is not None:
        from stickslip.plot import check_format

        check_format(plot, "--plot")
        check_writable(plot, "--plot")


def _checked_parameters(values: dict[str, float]) -> "Parameters":
    """Refuse values that are each in range and do not go together."""
    import warnings

    from stickslip_ref import Parameters

    with warnings.catch_warnings():
        # The engine gives its own warnings.
        warnings.simplefilter("ignore")
        try:
            return Parameters(**values)
        except ValueError as error:
            raise CommandError(str(error)) from error


def _run(
    engine: Engine,
    fmu: Path | None,
    values: dict[str, float],
    times: tuple[float, float, float | None],
    drawn: bool,
) -> "Run":
    import tempfile

    from stickslip import engines
    from stickslip.progress import Meter

    experiment = engines.experiment(values, *times, drawn=drawn)
    if engine is Engine.REFERENCE:
        with Meter("Simulating the reference"):
            run, notes = engines.simulate_reference(experiment)
    else:
        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            file = fmu or _build(Path(folder), "--fmu")
            with Meter("Simulating the FMU") as meter:
                run, notes = engines.simulate_fmu(experiment, file, meter.advance)
    for note in notes:
        _say(f"warning: {note}")
    return run


def _verdict(fmu: Path | None, cases: "Sequence[Case]", output: Path) -> "Verdict":
    from stickslip.files import check_writable, make_folder
    from stickslip.progress import Meter, deferred_interrupt
    from stickslip_verification import FmuError, verify, write_json

    if fmu is not None and not fmu.is_file():
        raise CommandError(f"--fmu {fmu}: no such file")
    make_folder(output.parent, "-o")
    check_writable(output, "-o")
    if fmu is None:
        fmu = _build(DEFAULT_FMU, "--fmu")
    with Meter("Verifying") as meter, deferred_interrupt() as interrupted:

        def show(what: str, done: int, total: int) -> None:
            if interrupted():
                raise KeyboardInterrupt
            meter.advance(done, total, what)

        try:
            # What the FMU warns of is part of the cases; on the terminal it would cut the progress.
            with contextlib.redirect_stderr(io.StringIO()):
                verdict = verify(fmu, cases, progress=show)
        except FmuError as error:
            raise CommandError(str(error)) from error
    write_json(verdict, output)
    return verdict
