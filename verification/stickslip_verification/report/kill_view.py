"""The kill matrix as the page shows it: per fault what caught it, and the cells of the matrix."""

from collections.abc import Sequence
from dataclasses import dataclass

from stickslip_verification.model.verdict import Detection, KillMatrix

CAUGHT, SURVIVED, NOT_JUDGED = "detected", "survived", "not judged"


@dataclass(frozen=True)
class Cell:
    """What a check did to a fault: its number of cases, and the classes of its look."""

    text: str
    look: str


@dataclass(frozen=True)
class FaultRow:
    """One planted fault; ``foretold`` and ``others`` are lists of checks in words."""

    mutant: str
    about: str
    word: str
    foretold: str
    others: str
    broken: str
    cells: Sequence[Cell]


@dataclass(frozen=True)
class KillView:
    """The matrix, its sums, and the checks that see no fault with the reason why they stay."""

    checks: Sequence[str]
    rows: Sequence[FaultRow]
    totals: Sequence[int]
    kills_nothing: Sequence[tuple[str, str]]
    whole: bool

    @property
    def caught(self) -> int:
        """Number of faults that a foretold check saw."""
        return sum(row.word == CAUGHT for row in self.rows)

    @property
    def survived(self) -> int:
        """Number of faults that no foretold check saw."""
        return sum(row.word == SURVIVED for row in self.rows)

    @property
    def broken(self) -> int:
        """Number of faults that could not be judged."""
        return sum(row.word == NOT_JUDGED for row in self.rows)


def of(kills: KillMatrix) -> KillView:
    """Make the view of a kill matrix."""
    most = max((cases for row in kills.rows for cases in row.failing.values()), default=1)
    return KillView(
        checks=kills.checks,
        rows=[_row(row, kills.checks, most) for row in kills.rows],
        totals=[sum(row.failing.get(check, 0) > 0 for row in kills.rows) for check in kills.checks],
        kills_nothing=list(kills.kills_nothing.items()),
        whole=kills.whole,
    )


def _row(row: Detection, checks: Sequence[str], most: int) -> FaultRow:
    return FaultRow(
        mutant=row.mutant,
        about=row.about,
        word=NOT_JUDGED if row.broken is not None else CAUGHT if row.caught else SURVIVED,
        foretold=", ".join(f"{check} ({row.failing.get(check, 0)})" for check in row.wanted),
        others=", ".join(
            f"{check} ({cases})" for check, cases in row.failing.items() if check not in row.wanted
        ),
        broken=row.broken or "",
        cells=[_cell(row.failing.get(check, 0), check in row.wanted, most) for check in checks],
    )


def _cell(cases: int, wanted: bool, most: int) -> Cell:
    # A third of the most, two thirds, more: three tints an eye tells apart.
    tint = f"h{1 + min(2, 3 * cases // (most + 1))}" if cases else ""
    text = str(cases) if cases or wanted else ""
    return Cell(text, " ".join(part for part in (tint, "wanted" if wanted else "") if part))
