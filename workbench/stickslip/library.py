"""What the command does, from Python: one function for each thing, and its result.

Arguments are numbers in SI, or texts with a unit (``"20 mm/s"``); results are in SI. Nothing is
printed, and what needs time takes `progress`.
"""

from __future__ import annotations

import io
import json
import math
import tempfile
import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import stickslip_ref
from stickslip.files import make_folder, writing
from stickslip.parameters import ParameterError, Parameters, above_zero
from stickslip.runs.engines import (
    check_slips,
    experiment,
    reference_parameters,
    simulate_fmu,
    simulate_reference,
)
from stickslip.runs.run import Run as Samples
from stickslip_fmu.laws.named import COULOMB_NAME

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure
    from rich.console import RenderableType

    import stickslip_verification as suite
    from stickslip.runs.run import Floats
    from stickslip_design.axis import AxisFile
    from stickslip_design.verdict import Verdict as AxisVerdict
    from stickslip_score import Curve
    from stickslip_score import Score as CurveScore

_MOST_SLIPS = (1_000_000, 10_000)
"""Slips that a run of the block, of the reference may have: each takes less than a minute."""
_WIDTH = 110
"""Characters in a line of a notebook."""


class Shown(ABC):
    """A result that shows itself: in a terminal by its repr, in a notebook as a table."""

    @abstractmethod
    def table(self) -> RenderableType:
        """Return the table that the command prints, for rich."""

    @abstractmethod
    def plot(self) -> Figure | None:
        """Draw it; None where there is nothing to draw."""

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """Return the figures in SI, as JSON knows them."""

    def to_json(self) -> str:
        """Return the figures in SI as JSON; what is not finite is null."""
        return json.dumps(_plain(self.to_dict()), indent=2, ensure_ascii=False, allow_nan=False)

    def _repr_html_(self) -> str:
        from rich.console import Console

        console = Console(record=True, width=_WIDTH, file=io.StringIO(), markup=False)
        console.print(self.table())
        return console.export_html(inline_styles=True, code_format="<pre>{code}</pre>")


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(name): _plain(each) for name, each in value.items()}
    if hasattr(value, "_asdict"):
        return _plain(value._asdict())
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


@dataclass(frozen=True, repr=False)
class Run(Samples, Shown):
    """A simulated run: samples of every output [SI], events, and the cycle they come to.

    ``run["x"]`` is an output by its name, ``run["time"]`` the time [s], each of shape (n,).
    """

    def __getitem__(self, name: str) -> Floats:
        column: Floats = self.samples[name]
        return column

    def __repr__(self) -> str:
        last = self.last
        return (
            f"<Run of the {self.engine}: {len(self.samples)} samples, "
            f"{self['time'][0]:g} to {last['time']:g} s, {last['n_slips']} slips, "
            f"last jump {last['delta_x']:.6g} m, period {last['T']:.6g} s>"
        )

    @property
    def _theory(self) -> stickslip_ref.Parameters | None:
        # The closed forms of the cycle are those of Coulomb's law.
        return _reference(self.parameters) if self.parameters.law == COULOMB_NAME else None

    def table(self) -> RenderableType:
        """Return the cycle beside the exact and the simplified one, for rich."""
        from stickslip.show.cycle_table import cycle_table

        return cycle_table(self, self._theory)

    def to_dict(self) -> dict[str, Any]:
        """Return the cycle [SI]: measured in the run, exact and simplified."""
        from stickslip.show.cycle_table import cycle_rows

        rows = {
            row.name: {
                "measured": row.measured, "exact": row.exact, "simplified": row.simplified
            }
            for row in cycle_rows(self, self._theory)
        }  # fmt: skip
        return {"engine": self.engine, "slips": int(self.last["n_slips"]), "cycle": rows}

    def to_dataframe(self) -> pandas.DataFrame:
        """Return the samples as a table of pandas, by time [s], units in ``attrs["units"]``."""
        from stickslip_design.datasets import need

        frame: pandas.DataFrame = need("pandas").DataFrame(self.samples).set_index("time")
        units = {row.name: row.unit for row in self.parameters.table.rows}
        frame.attrs["units"] = {str(name): units.get(str(name), "") for name in frame}
        return frame

    def plot(self) -> Figure:
        """Draw position and spring force over time."""
        from stickslip.show.plot import figure

        return figure(self)

    def write_csv(self, target: Path | str, option: str = "file") -> None:
        """Write the samples as a CSV file that fmpy reads; `option` names it in a refusal."""
        from stickslip.runs.csv_file import write_csv

        write_csv(self.samples, Path(target), option)

    def write_plot(self, target: Path | str, option: str = "file") -> None:
        """Draw into a .png, .svg or .pdf file; `option` names it in a refusal."""
        from stickslip.show.plot import write_plot

        write_plot(self, Path(target), option)


def simulate(
    p: Parameters | None = None,
    stop_time: float | str = 10.0,
    *,
    engine: str | Path = "block",
    start_time: float | str = 0.0,
    output_interval: float | str | None = None,
    most_slips: int | None = None,
    drawn: bool = False,
    progress: Callable[[float, float], None] = lambda done, total: None,
) -> Run:
    """Simulate one run, inputs held constant.

    Parameters
    ----------
    p
        The block; None: at its start values.
    stop_time, start_time
        Last and first time [s].
    engine
        ``"block"``: the FMU that `build` makes; ``"reference"``: the SciPy reference; or the path
        of an FMU.
    output_interval
        Distance of the samples [s]; None: 0.01 s, doubled until 1000 are enough.
    most_slips
        Slips that the run may have; None: 1,000,000, of the reference 10,000.
    drawn
        Whether a chosen interval is halved until a plot is smooth.
    progress
        Called with the time simulated and the time to simulate [s] after each step of an FMU.

    Raises
    ------
    ParameterError
        If an argument cannot be taken, or the run would have too many slips.
    FmuError, RuntimeError
        If the engine fails.
    """
    what = experiment(p or Parameters(), start_time, stop_time, output_interval, drawn=drawn)
    check_slips(what, most_slips or _MOST_SLIPS[engine == "reference"])
    if engine == "reference":
        run = simulate_reference(what)
    elif engine != "block":
        run = simulate_fmu(what, Path(engine), progress)
    else:
        from stickslip_fmu.packer import build as packed

        with tempfile.TemporaryDirectory(prefix="stickslip-") as folder:
            # Without its documentation, which takes nine tenths of the time.
            run = simulate_fmu(what, packed(Path(folder), law=what.parameters.law), progress)
    return Run(**{each.name: getattr(run, each.name) for each in fields(run)})


@dataclass(frozen=True, repr=False)
class Cycle(Shown):
    """The steady cycle [SI], exact and as designers write it; NaN where there is none."""

    parameters: Parameters
    exact: stickslip_ref.Cycle
    simplified: stickslip_ref.SimplifiedCycle

    def __repr__(self) -> str:
        exact = self.exact
        return (
            f"<Cycle: jump {exact.delta_x:.6g} m, stick {exact.t_stick:.6g} s, "
            f"slip {exact.t_slip:.6g} s, simplified jump {self.simplified.delta_x:.6g} m>"
        )

    def table(self) -> RenderableType:
        """Return both columns, for rich."""
        from stickslip.show.cycle_table import theory_table

        return theory_table(self.exact, self.simplified)

    def to_dict(self) -> dict[str, Any]:
        """Return both columns [SI]."""
        return {"exact": asdict(self.exact), "simplified": asdict(self.simplified)}

    def plot(self) -> Figure:
        """Draw the start from rest, and three cycles or as many periods of the free block."""
        p = self.parameters
        period = self.exact.T if math.inf > self.exact.T else 2.0 * math.pi * math.sqrt(p.m / p.k)
        load_up = p.mu_s * (p.m * p.g + p.load) / (p.k * abs(p.v)) if p.v else 0.0
        return simulate(p, float(load_up + 3.0 * period), engine="reference", drawn=True).plot()


def cycle(p: Parameters | None = None) -> Cycle:
    """Return the steady cycle of the block under Coulomb's friction law; docs/theory.md (6)-(13).

    Raises
    ------
    ValueError
        If the friction law is another one, which has no closed form.
    """
    p = p or Parameters()
    if p.law != COULOMB_NAME:
        raise ValueError(f"the friction law {p.law} has no closed form of its cycle: simulate it")
    reference = _reference(p)
    return Cycle(p, stickslip_ref.steady_cycle(reference), stickslip_ref.simplified(reference))


def _reference(p: Parameters) -> stickslip_ref.Parameters:
    with warnings.catch_warnings():
        # The engine gives its own warnings.
        warnings.simplefilter("ignore")
        return reference_parameters(p)


@dataclass(frozen=True, repr=False)
class Limits(Shown):
    """Where stick-slip ends.

    Attributes
    ----------
    velocities
        Intervals of the pulling velocity [m/s] at which a cycle with a stick exists, and at which
        steady sliding is unstable.
    regime
        What happens at the velocity of the block, where one was given; else None.
    notes
        Warnings.
    """

    velocities: stickslip_ref.CriticalVelocity
    regime: stickslip_ref.Regime | None
    notes: tuple[str, ...] = ()

    def __repr__(self) -> str:
        ranges = (
            ", ".join(f"{each.low:.6g} to {each.high:.6g} m/s" for each in found) or "nowhere"
            for found in (self.velocities.cycle, self.velocities.unstable)
        )
        return "<Limits: a cycle with a stick at {}; steady sliding unstable at {}>".format(*ranges)

    def table(self) -> RenderableType:
        """Return the intervals, for rich."""
        from stickslip.show.critical_table import critical_table

        return critical_table(self.velocities, self.regime)

    def to_dict(self) -> dict[str, Any]:
        """Return intervals and regime [SI]."""
        regime = None if self.regime is None else self.regime.words
        return {**self.velocities._asdict(), "at_v": regime}

    def plot(self) -> Figure:
        """Draw the intervals over the pulling velocity."""
        from stickslip.show.plot import bars

        rows = {
            "cycle with a stick": self.velocities.cycle,
            "unstable sliding": self.velocities.unstable,
        }
        return bars(rows, self.velocities.between)


def critical(
    p: Parameters | None = None,
    *,
    between: tuple[float | str | None, float | str | None] = (None, None),
) -> Limits:
    """Return at which pulling velocities a cycle with a stick exists, and sliding is unstable.

    Parameters
    ----------
    p
        The block. Where its `v` was given, what happens there is answered too.
    between
        Lowest and highest velocity to search [m/s]; None: chosen, so that it holds `v`.

    Raises
    ------
    ValueError, RuntimeError
        If the reference refuses the values, or cannot finish.
    """
    p = p or Parameters()
    ends = tuple(
        None if each is None else above_zero(each, "m/s", name)
        for each, name in zip(between, ("lowest", "highest"), strict=True)
    )
    low, high = ends
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        reference = reference_parameters(p)
        found = stickslip_ref.critical_velocity(reference, p.law, between=(low, high))
        there = None
        if "v" in p.given:
            wider = _holding(abs(p.v), (low, high), found.between)
            if wider is not None:
                found = stickslip_ref.critical_velocity(reference, p.law, between=wider)
            there = stickslip_ref.regime(reference, p.law) if p.v else None
    return Limits(found, there, tuple(str(each.message) for each in caught))


def _holding(
    speed: float, given: tuple[float | None, float | None], searched: tuple[float, float]
) -> tuple[float, float] | None:
    """Return the range searched made wider by a speed [m/s], where no given end is in its way.

    None if it need not or cannot be.
    """
    low, high = searched
    if 0.0 < speed < low and given[0] is None:
        return speed, high
    if speed > high and given[1] is None:
        return low, speed
    return None


def build(
    target: Path | str = "build",
    *,
    native: bool = False,
    fmi: Literal[2, 3] = 2,
    law: str = COULOMB_NAME,
    this_machine: bool = False,
) -> Path:
    """Build the FMU with its documentation, and return its path.

    Parameters
    ----------
    target
        A folder, or a file that ends in ``.fmu``.
    native
        Whether it is the FMU in C, for all platforms, or with the compiler of `this_machine` for
        that alone.
    fmi
        Version of the standard.
    law
        Name of the friction law.

    Raises
    ------
    OSError, ValueError
        If the file cannot be written, or friction law or version is not known.
    CompilerError
        If there is no compiler.
    """
    from stickslip.handbook import parts

    if fmi not in (2, 3):
        raise ParameterError("fmi", f" {fmi}: the standard is 2 or 3")
    place = Path(target)
    folder = place.parent if place.suffix == ".fmu" else place
    if not native:
        from stickslip_fmu.packer import build as packed

        make_folder(folder, "target")
        return packed(place, parts(fmi, law=law), fmi, law)
    from stickslip_native.compiler import compiler_for
    from stickslip_native.packer import build as compiled

    files = parts(fmi, compiler_for(this_machine).runtime(), law)
    make_folder(folder, "target")
    return compiled(place, files, fmi, this_machine, law)


@dataclass(frozen=True, repr=False)
class FmuVerdict(Shown):
    """A verdict on an FMU: `verdict` has all of it, and `meanings` what a failed check means."""

    verdict: suite.Verdict
    meanings: Mapping[str, suite.Meaning]

    @property
    def passed(self) -> bool:
        """Whether nothing that decides failed."""
        return self.verdict.passed

    @property
    def rows(self) -> Sequence[suite.CheckResult]:
        """The checks with what was expected, what came out, error and tolerance."""
        return self.verdict.checks

    def __repr__(self) -> str:
        from stickslip.show.verdict_summary import counts

        answers = [question.answer for question in self.verdict.questions]
        return "\n".join([*answers, str(counts(self.verdict))])

    def table(self) -> RenderableType:
        """Return the summary, for rich."""
        from stickslip.show.verdict_summary import verdict_summary

        return verdict_summary(self.verdict, self.meanings)

    def to_dict(self) -> dict[str, Any]:
        """Return the report as JSON knows it."""
        from stickslip_verification import as_json

        return as_json(self.verdict)

    def plot(self) -> Figure | None:
        """Draw the first case that failed, else the first one: motion, force, errors."""
        from stickslip_verification.report.plots import figure_of

        return figure_of(self.verdict)

    def report(self, folder: Path | str, *, full: bool = False) -> Path:
        """Write the report into a folder, every comparison on paper if `full`; return its page."""
        from stickslip_verification import write_report

        write_report(self.verdict, Path(folder), meanings=self.meanings, full=full)
        return Path(folder) / "index.html"


def verify(
    fmu: Path | str,
    *,
    cases: str | Path | None = None,
    names: Path | str | None = None,
    within: float | str | None = None,
    sequences: int | None = None,
    progress: Callable[[str, int, int], None] = lambda now, done, total: None,
    **options: Any,
) -> FmuVerdict:
    """Judge an FMU and the reference; a script that calls it guards its work by ``__main__``.

    Parameters
    ----------
    fmu, names
        The ``.fmu`` file, and the names file of one with names of its own.
    cases
        A shell pattern of cases, a folder or a file of cases of your own; None: all.
    within
        Part by which an FMU of the physics contract may be off, above 0 and below 1 or ``"1 %"``.
    sequences
        Number of random sequences; None: all, or none beside chosen cases.
    progress
        Called with what is being done, how much of it is done, and out of how much.
    options
        As of `stickslip_verification.verify`: ``contract``, ``strict``, ``jobs``, ``time_limit``,
        ``limits``, ``seed``, ``full``, ``command``.

    Raises
    ------
    FmuError
        If the file cannot be driven at all.
    ValueError
        If cases, names or another argument cannot be used.
    """
    import stickslip_verification as suite
    from stickslip_verification.suite.sequences import COUNT

    chosen = load_cases(cases)
    own = [each for case in chosen for each in case.own]
    verdict = suite.verify(
        Path(fmu),
        chosen,
        progress,
        names=None if names is None else suite.load_names(Path(names), own),
        sequences=sequences if sequences is not None else 0 if cases is not None else COUNT,
        long_probes=cases is None or Path(cases).is_dir(),
        within=share(within),
        **options,
    )
    return FmuVerdict(verdict, suite.meanings(chosen, suite.load_invariants()))


def share(within: float | str | None) -> float | None:
    """Return a part, above 0 and below 1; `ParameterError` if it is no such part."""
    if within is None:
        return None
    part = above_zero(within, "1", "within")
    if not part < 1.0:
        raise ParameterError(
            "within", f" {within}: must be above 0 % and below 100 %, as 1% or as 0.01"
        )
    return part


def load_cases(wanted: str | Path | None = None) -> list[suite.Case]:
    """Return the cases that a pattern, a folder or a file names; CaseError if there are none."""
    import stickslip_verification as suite

    if wanted is not None and Path(wanted).is_dir():
        return suite.load_cases(folder=Path(wanted))
    if wanted is not None and str(wanted).endswith(".toml"):
        return [suite.load_case(Path(wanted))]
    return suite.load_cases(None if wanted is None else str(wanted))


@dataclass(frozen=True, repr=False)
class CurveVerdict(Shown):
    """What a curve came to beside the exact cycle."""

    score: CurveScore
    curve: Curve

    def __repr__(self) -> str:
        return f"<CurveVerdict: {self.score.cause}, {self.score.explanation}>"

    @property
    def passed(self) -> bool:
        """Whether the curve is the exact one, within its noise or the tolerance of its solver."""
        return self.score.cause in ("exact", "noisy", "solver_tolerance")

    def plot(self) -> Figure:
        """Draw position and spring force of the curve over time, as far as it has them."""
        from stickslip.show.plot import panels

        curve = self.curve
        return panels(curve.t, {"x": curve.x, "F": curve.F}, str(self.score.cause))

    def table(self) -> RenderableType:
        """Return the comparison, for rich."""
        from stickslip.show.score_table import score_table

        return score_table(self.score)

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison [SI] as JSON knows it."""
        from stickslip_score import as_json

        return as_json(self.score)


def score(
    curve: Path | str,
    p: Parameters | None = None,
    *,
    time: str | None = None,
    x: str | None = None,
    x_dot: str | None = None,
    force: str | None = None,
) -> CurveVerdict:
    """Compare a curve from any tool with the exact cycle, and say why it differs.

    Parameters
    ----------
    curve
        A CSV file with at least t and x or F.
    p
        The block that the curve should show.
    time, x, x_dot, force
        Names of the columns with the unit that a header lacks (``"x [mm]"``); None: guessed.

    Raises
    ------
    CurveError, ValueError
        If the file cannot be read, or shows no such curve.
    """
    from stickslip_score import read_curve
    from stickslip_score import score as scored

    values = (p or Parameters()).values
    # A curve is compared under friction that does not grow with the time at rest.
    names = ("m", "g", "k", "c", "mu_s", "mu_k", "v", "load", "F_ext")
    columns = {"t": time, "x": x, "x_dot": x_dot, "F": force}
    read = read_curve(Path(curve), {k: name for k, name in columns.items() if name is not None})
    return CurveVerdict(scored(read, {name: values[name] for name in names}), read)


@dataclass(frozen=True, repr=False)
class Design(Shown):
    """Whether an axis judders, and what is measured against it; `verdict` has all figures."""

    verdict: AxisVerdict

    def __repr__(self) -> str:
        return f"<Design of {self.verdict.axis.name}: {self.verdict.sentence}>"

    def table(self) -> RenderableType:
        """Return the summary, for rich."""
        from stickslip.show.design_summary import design_summary

        return design_summary(self.verdict)

    def to_dict(self) -> dict[str, Any]:
        """Return the verdict [SI] as JSON knows it."""
        from stickslip_design.report import data

        return data(self.verdict)

    def html(self) -> str:
        """Return the report as a page that asks for nothing outside itself."""
        from stickslip_design.report import html

        return html(self.verdict)

    def plot(self) -> Figure | None:
        """Draw the motions over the feed; None for an unstable loop."""
        from stickslip_design.report.plots import feeds

        return feeds(self.verdict)

    def report(self, file: Path | str) -> Path:
        """Write the report, and return its path."""
        with writing(Path(file), "file") as stream:
            stream.write(self.html().encode())
        return Path(file)


def design(axis: AxisFile | Path | str | Mapping[str, Any]) -> Design:
    """Return whether a feed axis judders, and what is measured against it.

    Parameters
    ----------
    axis
        The axis file, or what it says as a dictionary of its tables; docs/axis-file.md.

    Raises
    ------
    AxisError
        If the axis cannot be read; one line with key, value and range.
    """
    from stickslip_design.axis import AxisFile, axis_file_of, read_axis_file
    from stickslip_design.study import design as designed

    if isinstance(axis, Mapping):
        axis = axis_file_of("\n".join(_toml(axis)), "axis")
    return Design(designed(axis if isinstance(axis, AxisFile) else read_axis_file(axis)))


def _toml(tables: Mapping[str, Any]) -> list[str]:
    """Return tables of an axis as lines of its file; JSON writes such values as TOML does."""
    lines: list[str] = []
    for name, table in tables.items():
        lines.append(f"[{name}]")
        for key, value in table.items():
            nested = isinstance(value, list) and value and isinstance(value[0], Mapping)
            if not nested:
                lines.append(f"{key} = {json.dumps(value, ensure_ascii=False)}")
        for key, value in table.items():
            for item in value if isinstance(value, list) else ():
                if isinstance(item, Mapping):
                    lines.append(f"[[{name}.{key}]]")
                    lines += [f"{k} = {json.dumps(v, ensure_ascii=False)}" for k, v in item.items()]
    return lines
