"""What the command says of FMUs, curves and axes, from Python; as `stickslip.library`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.files import write
from stickslip.parameters import ParameterError, Parameters, above_zero
from stickslip.results import Shown
from stickslip.show.tables import design_summary, of_grid, score_table
from stickslip_units import turning

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType

    import stickslip_verification as suite
    from stickslip_design.axis import Axis, AxisSource
    from stickslip_design.verdict import Verdict as AxisVerdict
    from stickslip_score import Curve
    from stickslip_score import Score as CurveScore


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
        from stickslip.show.verdict import counts

        answers = [question.answer for question in self.verdict.questions]
        return "\n".join([*answers, str(counts(self.verdict))])

    def table(self) -> RenderableType:
        """Return the summary, for rich."""
        from stickslip.show.verdict import verdict_summary

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
        Shell patterns of cases, a folder or a file of cases of your own; None: all.
    within
        Part by which an FMU of the physics contract may be off, above 0 and below 1 or ``"1 %"``.
    sequences
        Number of random sequences; None: all, or none beside chosen cases.
    progress
        Called with what is being done, how much of it is done, and out of how much.
    options
        As of `stickslip_verification.verify`: ``interface`` (``"me"``: solved), ``contract``,
        ``strict``, ``jobs``, ``time_limit``, ``limits``, ``seed``, ``full``, ``command``.

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
        with turning(self.verdict.axis.turns):
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
        write(Path(file), self.html().encode(), "file")
        return Path(file)


def design(axis: AxisSource | Axis, *, presliding: bool = False) -> Design:
    """Return whether a feed axis judders, and what is measured against it.

    Parameters
    ----------
    axis
        The axis file, what it says as a dictionary of its tables, docs/axis-file.md; or an axis.
    presliding
        Whether to say what presliding makes of it, too: some seconds more.

    Raises
    ------
    AxisError
        If the axis cannot be read; one line with key, value and range.
    """
    from stickslip_design.axis import Axis, read_axis_file
    from stickslip_design.study import design as designed

    source = axis if isinstance(axis, Axis) else read_axis_file(axis)
    return Design(designed(source, presliding=presliding))


@dataclass(frozen=True, repr=False)
class Comparison(Shown):
    """Axes side by side; `verdicts` has all figures, by the names of the axes."""

    verdicts: Mapping[str, AxisVerdict]

    def __repr__(self) -> str:
        return "\n".join(f"{name}: {found.sentence}" for name, found in self.verdicts.items())

    def table(self) -> RenderableType:
        """Return a column for each axis, the numbers that differ first, for rich."""
        from stickslip_design.report import comparison

        with turning(self._turns):
            return of_grid(comparison(self.verdicts))

    @property
    def _turns(self) -> bool:
        return all(found.axis.turns for found in self.verdicts.values())

    def to_dict(self) -> dict[str, Any]:
        """Return the verdicts [SI] by axis, as JSON knows them."""
        from stickslip_design.report import data

        return {name: data(found) for name, found in self.verdicts.items()}

    def plot(self) -> Figure:
        """Draw the feeds at which each axis jumps."""
        from stickslip.show.plot import bars

        jumps = {name: found.cycle for name, found in self.verdicts.items()}
        with turning(self._turns):
            return bars(jumps, (0.0, math.inf), "feed")


def compare(axes: Mapping[str, AxisSource] | Iterable[Path | str]) -> Comparison:
    """Return what two axes or more do, side by side: axis files, or by name what `design` takes.

    Raises
    ------
    AxisError, ValueError
        If an axis cannot be read, in one line; if there is but one, or a slide beside a table.
    """
    from stickslip_design.axis import axis_file_of, read_axis_file
    from stickslip_design.study import design as designed

    named = axes if isinstance(axes, Mapping) else {str(axis): axis for axis in axes}
    if len(named) < 2:
        raise ValueError("a comparison needs two axes or more, each of them once")
    files = {
        name: axis_file_of(axis, name) if isinstance(axis, Mapping) else read_axis_file(axis)
        for name, axis in named.items()
    }
    found = {name: designed(file) for name, file in files.items()}
    if len({each.axis.turns for each in found.values()}) > 1:
        raise ValueError("a rotary table and a slide have no units in common: compare each kind")
    return Comparison(found)
