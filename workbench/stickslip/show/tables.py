"""Results as tables that fit the line they are printed on: limits, cycles, scores, sweeps, axes."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console, ConsoleOptions, Group, JustifyMethod, RenderableType, RenderResult
from rich.measure import Measurement
from rich.segment import Segment
from rich.table import Table
from rich.text import Text

from stickslip_units import scale_for

if TYPE_CHECKING:
    import xarray

    import stickslip_ref
    from stickslip.runs import Run
    from stickslip_design.identify.model import Identified
    from stickslip_design.report.tables import Grid
    from stickslip_design.verdict import Verdict
    from stickslip_ref import CriticalVelocity, Regime
    from stickslip_score import Compared, Score

_UNBOUND: Final = 10_000
"""Characters in a line that fits any table."""


def grid(
    head: Sequence[str],
    rows: Iterable[Sequence[Any]] = (),
    *,
    texts: Collection[int] = (0,),
    title: str | None = None,
    without: Collection[int] = (),
    styles: Mapping[int, str] = MappingProxyType({}),
    **look: Any,
) -> Table:
    """Make a table: its headings, its rows, and which columns are texts and not numbers.

    The columns `without` are left out; the first one that stays has the first heading.
    """
    table = Table(title=title, title_justify="left", title_style="bold", box=SIMPLE_HEAD, **look)
    shown = [place for place in range(len(head)) if place not in without]
    for place in shown:
        heading = head[0] if place == shown[0] else head[place]
        justify: JustifyMethod = "left" if place in texts else "right"
        table.add_column(heading, justify=justify, style=styles.get(place), overflow="fold")
    for row in rows:
        table.add_row(*(row[place] for place in shown if place < len(row)))
    return table


class Fitted:
    """A table in the fullest form that fits the line, with notes below and no blanks at line ends.

    Parameters
    ----------
    forms
        The same table, the widest first. The last one is taken where none fits.
    notes
        What stands below the table.
    folded
        Whether a form fits when its texts are folded between words.
    """

    def __init__(
        self, forms: Sequence[RenderableType], *notes: RenderableType, folded: bool = False
    ) -> None:
        self._forms, self._notes, self._folded = forms, notes, folded

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        unbound = options.update(max_width=_UNBOUND)
        needed = {form: Measurement.get(console, unbound, form) for form in self._forms}
        fitting = (
            form
            for form, (folded, whole) in needed.items()
            if (folded if self._folded else whole) <= options.max_width
        )
        shown = Group(next(fitting, self._forms[-1]), *self._notes)
        for line in console.render_lines(shown, options, pad=False):
            for text, style, control in _without_blanks_at_the_end(line):
                yield Segment(text.replace(_NO_BREAK, " "), style, control)
            yield Segment.line()


def _without_blanks_at_the_end(line: list[Segment]) -> list[Segment]:
    while line and not line[-1].text.strip():
        line.pop()
    if line:
        text, style, control = line.pop()
        line.append(Segment(text.rstrip(), style, control))
    return line


def critical_table(
    found: CriticalVelocity, there: Regime | None = None, v: float = 0.0
) -> RenderableType:
    """Make the table of a limit, with what happens, else what exists, at a velocity if given."""
    rows: list[tuple[str, ...]] = []
    for name, intervals in (
        ("a cycle with a stick exists", found.cycle),
        ("steady sliding is unstable", found.unstable),
    ):
        ends = [
            (_speed(low), _kind(low, low_end), _speed(high), _kind(high, high_end))
            for low, high, low_end, high_end in intervals
        ] or [("none exists" if found.proven else "none found", "", "", "")]
        rows += [("" if number else name, *cells) for number, cells in enumerate(ends)]
    notes = [f"no cycle: {found.reason}"] if found.reason else []
    if there is not None:
        settles = ""
        if there.kinds == ("even",) and not math.isinf(there.settling):
            settles = (
                f": within 5 % of the speed {there.settling:.3g} s after it breaks away from rest"
            )
        notes.append(f"at {_speed(there.speed)} the mass {there.words}{settles}")
    elif v:
        notes.append(f"at {_speed(v)} the mass {motions(found, v)}")
    if not found.proven:
        low, high = map(_speed, found.between)
        notes.append(
            f"searched: {low} to {high} (--from, --to); nothing narrower than 1 % of v was looked "
            "for"
        )
    table = grid(("", "from", "", "to", ""), rows, texts=(0, 2, 4))
    return Group(table, *(Text(note) for note in notes))


def motions(found: CriticalVelocity, v: float) -> str:
    """Return which motions exist at a velocity [m/s], in words."""
    words = {"sticks": "sticks and slips", "swings": "swings", "even": "moves evenly"}
    return ", or after another start ".join(words[each] for each in found.motions(v))


def _kind(v: float, kind: str) -> str:
    return "" if v in (0.0, math.inf) else "search" if kind == "none" else kind


def _speed(v: float) -> str:
    return "no end" if math.isinf(v) else scale_for(v, "m/s").text(v)


_ROWS: tuple[tuple[str, str, str], ...] = (
    ("F_s", "break-away force", "N"),
    ("spring_drop", "spring relief in a slip", "m"),
    ("delta_x", "jump of the mass", "m"),
    ("t_stick", "time in stick", "s"),
    ("t_slip", "time in slip", "s"),
    ("T", "period", "s"),
    ("f", "frequency", "Hz"),
    ("x_dot_peak", "peak velocity", "m/s"),
)


class Row(NamedTuple):
    """A quantity of the cycle, SI: measured in the run, exact and simplified; NaN where none."""

    name: str
    meaning: str
    unit: str
    measured: float
    exact: float
    simplified: float


def cycle_rows(run: Run, p: stickslip_ref.Parameters | None) -> Iterator[Row]:
    """Return the rows of the table: the last cycle of the run, and both columns of the theory.

    Without parameters, under a friction law without such formulas, both columns are empty.
    """
    import stickslip_ref

    exact = designers = None
    if p is not None:
        exact, designers = stickslip_ref.steady_cycle(p), stickslip_ref.simplified(p)
    last = run.last
    # What the meter has filled. The output F_s is that of the last sample; where static friction
    # ages both theories have that of the break-away.
    seen = [] if p is not None and stickslip_ref.COULOMB.ages(p) else ["F_s"]
    seen += ["spring_drop", "delta_x", "t_slip", "x_dot_peak"] if last["n_slips"] > 0 else []
    seen += ["t_stick", "T", "f"] if last["T"] > 0.0 else []
    return _rows({name: float(last[name]) for name in seen}, exact, designers)


def _rows(measured: Mapping[str, float], exact: object, designers: object) -> Iterator[Row]:
    for name, meaning, unit in _ROWS:
        both = (float(getattr(each, name, math.nan)) for each in (exact, designers))
        yield Row(name, meaning, unit, measured.get(name, math.nan), *both)


def cycle_table(run: Run, p: stickslip_ref.Parameters | None) -> RenderableType:
    """Make the table of the cycle, with a line that says so where there is none.

    Where the line is short, what the quantities mean is left out; where it is shorter still, the
    deviations are too. Without parameters there is one column, that of the run.
    """
    rows = list(cycle_rows(run, p))
    if p is None:
        return _table(_title(run), rows, range(4, 8))
    forms = [_table(_title(run), rows, without) for without in ((), (0,), (0, 4, 7))]
    notes = list(_no_cycle(run, p))
    # The break-away force is the same in all columns and needs no note.
    if any(not math.isnan(row.simplified) for row in rows if row.name != "F_s"):
        notes.append(
            "simplified: as designers write it; its jump is the spring's relief, its time in stick "
            "the first load-up, its time in slip the limit for v → 0"
        )
    return Fitted(forms, *(Text(note) for note in notes))


def theory_table(
    exact: stickslip_ref.Cycle, designers: stickslip_ref.SimplifiedCycle
) -> RenderableType:
    """Make the table of the steady cycle, exact and as designers write it."""
    rows = list(_rows({}, exact, designers))
    return _table("Steady cycle", rows, (3, 4))


def _table(title: str, rows: Iterable[Row], without: Collection[int]) -> Table:
    lines = []
    for row in rows:
        shown = next((x for x in (row.exact, row.measured, row.simplified) if x == x), 0.0)
        scale = scale_for(shown, row.unit)
        cells = [row.meaning, row.name, scale.symbol]
        for value in (row.measured, row.exact, row.simplified):
            cells += [_number(value / scale.size), _deviation(value, row.exact)]
        # The exact one deviates by nothing.
        lines.append([*cells[:6], *cells[7:]])
    columns = ("measured", "from exact", "exact", "simplified", "from exact")
    head = ("quantity", "", "unit", *columns)
    styles = {3: "bold", 4: "bold", 6: "dim", 7: "dim"}
    return grid(head, lines, texts=range(3), title=title, without=without, styles=styles)


def _title(run: Run) -> str:
    slips = int(run.last["n_slips"])
    start, stop = float(run.samples["time"][0]), float(run.last["time"])
    return f"{run.engine}: {slips} slip{'' if slips == 1 else 's'} in {stop - start:g} s"


def _no_cycle(run: Run, p: stickslip_ref.Parameters) -> Iterator[str]:
    """Say why a column of the table is empty."""
    import stickslip_ref

    exact = stickslip_ref.steady_cycle(p)
    if not exact.exists:
        yield f"No steady stick-slip cycle exists: {_why_none(p)}."
    elif not run.last["T"] > 0.0:
        missing = "never broke away" if run.last["mode"] == 0 else "slips since the start"
        if run.last["n_slips"] > 0 or run.events:
            missing = "did not break away twice"
        yield (
            f"No cycle in this run: the mass {missing}; "
            f"a cycle of these parameters takes {exact.T:.4g} s after the first break-away."
        )


def _why_none(p: stickslip_ref.Parameters) -> str:
    import stickslip_ref

    if p.v == 0.0:
        return "the pulled end does not move (v = 0)"
    if p.zeta >= 1.0:
        return f"the slip is over-damped (zeta = {p.zeta:.4g}) and ends in steady sliding"
    if p.Delta == 0.0:
        return "without a gap between mu_s and mu_k the damped slip ends in steady sliding"
    if stickslip_ref.COULOMB.ages(p):
        return f"at this speed the mass {stickslip_ref.regime(p).words}"
    v_c = float(stickslip_ref.coulomb_limit(p))
    limit = scale_for(v_c, "m/s").text(v_c, ".4g")
    return f"|v| is above the critical velocity v_c = {limit}, so a slip ends in steady sliding"


def _number(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.6g}"


def _deviation(value: float, exact: float) -> str:
    if math.isnan(value) or math.isnan(exact):
        return "–"
    if value == exact:
        return "0"
    if exact == 0.0:
        return "–"
    deviation = (value - exact) / exact
    return f"{deviation:+.1e}" if abs(deviation) < 1e-4 else f"{100.0 * deviation:+.2f} %"


_QUANTITIES: Final[tuple[tuple[str, str, str], ...]] = (
    ("period", "T", "s"),
    ("stick", "t_stick", "s"),
    ("slip", "t_slip", "s"),
    ("jump", "delta_x", "m"),
)


def score_table(score: Score) -> RenderableType:
    """Make the table of a score: curve beside exact cycle, then cause, sentence and findings.

    Errors and resolutions stand each in a unit of their own size; symbols and resolution are left
    out where the line is short.
    """
    title = (
        f"Curve against exact cycle, mean of {score.cycles} cycle{'' if score.cycles == 1 else 's'}"
    )
    head = ("quantity", "", "curve", "exact", "error", "resolution")
    rows = [
        (meaning, name, *_cells(getattr(score, "period" if name == "T" else name), unit))
        for meaning, name, unit in _QUANTITIES
    ]
    forms = [
        grid(head, rows, texts=(0, 1), title=title, without=without)
        for without in ((), (5,), (1, 5))
    ]
    mild = dict.fromkeys(("noisy", "solver_tolerance"), "bold yellow")
    style = {"exact": "bold green", **mild}.get(score.cause, "bold red")
    cause = Text.assemble((score.cause, style), f": {_sentence(score)}")
    return Fitted(forms, cause, *(Text(f"note: {finding}") for finding in score.findings))


def _sentence(score: Score) -> str:
    """Return the explanation without the name of the cause that stands before it."""
    first, colon, rest = score.explanation.partition(": ")
    return rest if colon and first.startswith(("regularised", "fixed steps")) else score.explanation


def _cells(compared: Compared, unit: str) -> Iterator[str]:
    shown = next((x for x in (compared.exact, compared.got) if x is not None), 0.0)
    of_motion = scale_for(shown, unit)
    for value in (compared.got, compared.exact):
        yield "–" if value is None else of_motion.text(value)
    for value, sign, form in ((compared.error, "", "+.3g"), (compared.resolution, "±", ".3g")):
        yield "–" if value is None else sign + scale_for(value, unit).text(value, form)


MOST_REASONS: Final = 8
"""Reasons of failures that are shown, the most frequent first."""

_NUMBER: Final = re.compile(r"[+-]?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?")


def sweep_summary(found: xarray.Dataset) -> RenderableType:
    """Make the summary of a sweep."""
    reasons = [str(each) for each in found["failure"].values.ravel().tolist() if each]
    runs = int(found["failure"].size)
    failed = f", {len(reasons)} failed" if reasons else ", none failed"
    said = Text(f"{runs} run{'' if runs == 1 else 's'}{failed}")
    parts: list[RenderableType] = [_results(found), said]
    # Messages of one reason differ in their numbers.
    alike = Counter(_NUMBER.sub("...", each) for each in reasons)
    first = {_NUMBER.sub("...", each): each for each in reversed(reasons)}
    for kind, count in alike.most_common(MOST_REASONS):
        such = "such as: " if count > 1 and kind != first[kind] else ""
        parts.append(Text(f"  {count} x {such}{first[kind]}"))
    if len(alike) > MOST_REASONS:
        parts.append(Text(f"  and {len(alike) - MOST_REASONS} more reasons"))
    return Group(*parts)


def _results(found: xarray.Dataset) -> Table:
    rows = []
    ok = found["failure"].values.ravel() == ""
    for name, column in found.data_vars.items():
        if name == "failure":
            continue
        values = np.asarray(column.values).ravel()[ok]
        known = values[~np.isnan(values)]
        ends = [f"{known.min():.6g}", f"{known.max():.6g}"] if known.size else ["", ""]
        lacking = str(values.size - known.size) if values.size > known.size else ""
        about = column.attrs
        rows.append((name, about.get("units", ""), *ends, lacking, about.get("long_name", "")))
    return grid(("result", "unit", "least", "greatest", "NaN", "meaning"), rows, texts=(0, 1, 5))


_HELD: Final = re.compile(r"(?<=[\d∞→]) |(?<![,;]) (?=[\d∞])")
"""The blanks between a name, its number and its unit."""
_NO_BREAK: Final = "\N{BRAILLE PATTERN BLANK}"
"""What stands for it while lines are folded: rich folds at a no-break space too."""
_TONES: Final = {"good": "bold green", "warn": "bold yellow", "bad": "bold red"}


def design_summary(verdict: Verdict) -> RenderableType:
    """Make the first page of the report on an axis in 80 columns, without its pictures."""
    # It brings the loop, which no other table needs.
    from stickslip_design.report import tables

    found = tables.standing(verdict)
    parts: list[RenderableType] = [
        Text.assemble(verdict.axis.name, ": ", (found.word, _TONES[found.tone])),
        Text(verdict.sentence),
        Text(f"critical feed: {tables.critical(verdict)}"),
    ]
    if verdict.robustness is not None:
        parts.append(Text(f"as it is: {tables.robust(verdict)}"))
    if verdict.stable and verdict.axis.drive is not None:
        parts.append(Text(f"at a target: {tables.hunting(verdict)[0]}"))
    parts += map(Text, verdict.with_presliding)
    points = tables.operating_points(verdict).of(*range(5))
    if points.rows:
        parts.append(of_grid(points))
    measures = tables.measures(verdict)
    rows = [
        (f"{name} ({effort})\n  {moves}", *row)
        for name, effort, moves, *row, _ in measures.rows[: tables.FIRST]
    ]
    if rows:
        head = ("measure, and what it moves", *measures.head[3:-1])
        parts.append(of_grid(tables.Grid(head, rows, frozenset(range(1, len(head))))))
    if others := tables.others(verdict):
        parts.append(Text(f"other measures, with reasons in the report: {others}"))
    return Group(*parts)


def identified_summary(found: Identified, source: str, then: str) -> RenderableType:
    """Make the summary of what a record tells, in 80 columns; `then` is what the axis does."""
    from stickslip_design.identify import report

    numbers = report.numbers(found)
    rows = [(f"{name}\n  {meaning}", "", *row) for name, meaning, *row in numbers.rows]
    said = [f"cannot tell {what}: {why}" for what, why in found.missing]
    next_one = [f"measure next: {found.next_measurement}"] if found.next_measurement else []
    return Group(
        Text.assemble(f"{source}: ", (found.kind, "bold"), f", as {found.reason}"),
        of_grid(numbers._replace(rows=rows).of(0, 2, 3, 4, 5)),
        *map(Text, (*said, *found.notes)),
        Text(report.explains(found), "" if found.explained else "bold yellow"),
        *map(Text, next_one),
        Text(then, "bold"),
    )


def of_grid(shown: Grid) -> RenderableType:
    """Make the table of a grid; where its texts can be folded its numbers are not."""
    texts = [place for place in range(len(shown.head)) if place not in shown.numbers]
    rows = [[_HELD.sub(_NO_BREAK, cell) for cell in row] for row in shown.rows]
    table, narrow = (grid(shown.head, rows, texts=texts) for _ in range(2))
    for place in shown.numbers:
        table.columns[place].no_wrap = True
        table.columns[place].min_width = max(len(row[place]) for row in (shown.head, *shown.rows))
    return Fitted([table, narrow], folded=True)
