"""The table of what happened in the random sequences."""

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import product

from stickslip_verification.judge.checks import of_invariant
from stickslip_verification.judge.contract import Contract
from stickslip_verification.model.verdict import CheckResult, Table
from stickslip_verification.suite import sequences as table
from stickslip_verification.suite.invariants import Manner
from stickslip_verification.suite.sequences import CELLS, RandomSequence, Scope, coverage


def coverage_table(sequences: Sequence[RandomSequence], seed: int, scope: Scope) -> Table:
    """Count how often what changed in which phase, at which damping."""
    counts = coverage(sequences)
    reasons = Counter(scope.hindrance(cell) for cell in CELLS if not counts[cell])
    rows: list[list[str | int]] = []
    for row, phase in product(table.ROWS, table.PHASES):
        cells = (table.Cell(row, phase, damping) for damping in table.DAMPINGS)
        rows.append([f"{row}, in {phase}", *(counts[cell] for cell in cells)])
    return Table(
        title="Random sequences",
        about="How often what changed in which phase, at which damping from then on: "
        f"{len(sequences)} sequences of seed {seed}.",
        head=("what changes, and when", *table.DAMPINGS),
        rows=rows,
        note=" ".join(f"{n} cells cannot be filled: {why}." for why, n in reasons.items() if why),
    )


def gaps(
    sequences: Sequence[RandomSequence],
    scope: Scope,
    contract: Contract,
    manners: Sequence[Manner],
) -> Iterator[CheckResult]:
    """Yield a failure of the suite where sequences that should fill the table leave cells empty."""
    counts = coverage(sequences)
    empty = [cell for cell in CELLS if not counts[cell] and scope.hindrance(cell) is None]
    if len(sequences) >= table.COUNT and empty and manners:
        cells = "; ".join(", ".join(cell) for cell in empty)
        failure = f"the suite itself: its random sequences have no {cells}"
        yield of_invariant(manners[0], "", contract, failure=failure)
