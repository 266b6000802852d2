"""The cycle of a run beside the exact steady cycle and the one that designers write."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

import stickslip_ref
from stickslip.runs.run import Run
from stickslip.show.fitted import Fitted, grid
from stickslip.show.scales import FORCES, FREQUENCIES, LENGTHS, TIMES, VELOCITIES, Scales, scale_for

_ROWS: tuple[tuple[str, str, Scales], ...] = (
    ("F_s", "break-away force", FORCES),
    ("spring_drop", "spring relief in a slip", LENGTHS),
    ("delta_x", "jump of the mass", LENGTHS),
    ("t_stick", "time in stick", TIMES),
    ("t_slip", "time in slip", TIMES),
    ("T", "period", TIMES),
    ("f", "frequency", FREQUENCIES),
    ("x_dot_peak", "peak velocity", VELOCITIES),
)


_STYLES = {"measured": "bold", "exact": "", "simplified": "dim"}


@dataclass(frozen=True)
class Row:
    """A quantity of the cycle, SI: measured in the run, exact and simplified; NaN where none."""

    name: str
    meaning: str
    scales: Scales
    measured: float
    exact: float
    simplified: float


def cycle_rows(run: Run, p: stickslip_ref.Parameters | None) -> Iterator[Row]:
    """Return the rows of the table: the last cycle of the run, and both columns of the theory.

    Without parameters, under a friction law without such formulas, both columns are empty.
    """
    exact = designers = None
    if p is not None:
        exact, designers = stickslip_ref.steady_cycle(p), stickslip_ref.simplified(p)
    seen = _measured_names(run)
    if p is not None and stickslip_ref.COULOMB.ages(p):
        # The output shows the value of the last sample, and both theories that of the break-away.
        seen -= {"F_s"}
    return _rows({name: float(run.last[name]) for name in seen}, exact, designers)


def _rows(measured: Mapping[str, float], exact: object, designers: object) -> Iterator[Row]:
    for name, meaning, scales in _ROWS:
        both = (float(getattr(each, name, math.nan)) for each in (exact, designers))
        yield Row(name, meaning, scales, measured.get(name, math.nan), *both)


def cycle_table(run: Run, p: stickslip_ref.Parameters | None) -> RenderableType:
    """Make the table of the cycle, with a line that says so where there is none.

    Where the line is short, what the quantities mean is left out; where it is shorter still, the
    deviations are too. Without parameters there is one column, that of the run.
    """
    rows = list(cycle_rows(run, p))
    if p is None:
        return _table(_title(run), rows, ("measured",))
    forms = [
        _table(_title(run), rows, explained=explained, compared=compared)
        for explained, compared in ((True, True), (False, True), (False, False))
    ]
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
    return _table("Steady cycle", rows, ("exact", "simplified"))


def _table(
    title: str,
    rows: Sequence[Row],
    columns: Sequence[str] = ("measured", "exact", "simplified"),
    *,
    explained: bool = True,
    compared: bool = True,
) -> Table:
    compared = compared and "exact" in columns
    lines = []
    for row in rows:
        shown = next((x for x in (row.exact, row.measured, row.simplified) if x == x), 0.0)
        scale = scale_for(shown, row.scales)
        cells = [row.meaning] if explained else []
        cells += [row.name, scale.symbol]
        for name in columns:
            value: float = getattr(row, name)
            cells.append(_number(value / scale.size))
            if compared and name != "exact":
                cells.append(_deviation(value, row.exact))
        lines.append(cells)
    head = ["quantity", "", "unit"] if explained else ["quantity", "unit"]
    texts = range(len(head))
    styles = [""] * len(head)
    for name in columns:
        own = [name, "from exact"] if compared and name != "exact" else [name]
        head += own
        styles += [_STYLES[name]] * len(own)
    table = grid(head, lines, texts=texts, title=title)
    for column, style in zip(table.columns, styles, strict=True):
        column.style = style
    return table


def _measured_names(run: Run) -> set[str]:
    """Name the rows that the meter has filled by the end of the run."""
    last = run.last
    names = {"F_s"}
    if last["n_slips"] > 0:
        names |= {"spring_drop", "delta_x", "t_slip", "x_dot_peak"}
    if last["T"] > 0.0:
        names |= {"t_stick", "T", "f"}
    return names


def _title(run: Run) -> str:
    slips = int(run.last["n_slips"])
    start, stop = float(run.samples["time"][0]), float(run.last["time"])
    return f"{run.engine}: {slips} slip{'' if slips == 1 else 's'} in {stop - start:g} s"


def _no_cycle(run: Run, p: stickslip_ref.Parameters) -> Iterator[str]:
    """Say why a column of the table is empty."""
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
    if p.v == 0.0:
        return "the pulled end does not move (v = 0)"
    if p.zeta >= 1.0:
        return f"the slip is over-damped (zeta = {p.zeta:.4g}) and ends in steady sliding"
    if p.Delta == 0.0:
        return "without a gap between mu_s and mu_k the damped slip ends in steady sliding"
    if stickslip_ref.COULOMB.ages(p):
        return f"at this speed the mass {stickslip_ref.regime(p).words}"
    v_c = float(stickslip_ref.coulomb_limit(p))
    scale = scale_for(v_c, VELOCITIES)
    return (
        f"|v| is above the critical velocity v_c = {v_c / scale.size:.4g} {scale.symbol}, "
        "so a slip ends in steady sliding"
    )


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
