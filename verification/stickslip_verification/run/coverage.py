"""The table of what happened in the random sequences."""

from collections.abc import Sequence

from stickslip_verification.model.verdict import Table
from stickslip_verification.suite.sequences import (
    COUNT,
    DAMPINGS,
    PHASES,
    ROWS,
    Cell,
    RandomSequence,
    Scope,
    coverage,
)

EMPTY = "0"
"""Shown in a cell that should have happened and has not."""


def coverage_table(sequences: Sequence[RandomSequence], seed: int, scope: Scope) -> Table:
    """Count how often what changed in which phase at which damping."""
    counts = coverage(sequences)
    rows, reasons = [], {}
    for row in ROWS:
        for phase in PHASES:
            cells = [Cell(row, phase, damping) for damping in DAMPINGS]
            rows.append((f"{row}, in {phase}", *(counts[cell] for cell in cells)))
            for cell in cells:
                reason = scope.hindrance(cell)
                if reason is not None and not counts[cell]:
                    reasons.setdefault(reason, []).append(cell)
    note = " ".join(
        f"{len(cells)} cells cannot be filled: {reason}." for reason, cells in reasons.items()
    )
    return Table(
        title="Random sequences",
        about=(
            f"How often what changed in which phase, at which damping from then on: "
            f"{len(sequences)} sequences of seed {seed}."
        ),
        head=("what changes, and when", *DAMPINGS),
        rows=rows,
        note=note,
    )


def empty_cells(sequences: Sequence[RandomSequence], scope: Scope) -> list[Cell]:
    """Return the cells that sequences of this number should have filled and have not."""
    if len(sequences) < COUNT:
        return []
    counts = coverage(sequences)
    return [
        Cell(row, phase, damping)
        for row in ROWS
        for phase in PHASES
        for damping in DAMPINGS
        if not counts[Cell(row, phase, damping)]
        and scope.hindrance(Cell(row, phase, damping)) is None
    ]
