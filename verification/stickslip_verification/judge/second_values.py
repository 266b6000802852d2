"""Second values: beside the truth, what each check gave when it was last accepted.

A drift far below a tolerance is still a change that somebody should know of. Only the tool
writes them, `stickslip verify --accept`; a value that misses its truth is never accepted.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from stickslip_verification.model.verdict import CheckResult, Second, Verdict
from stickslip_verification.model.whole_file import write_whole
from stickslip_verification.suite.cases import load_cases
from stickslip_verification.truth import COULOMB_NAME

FILE = Path(__file__).parents[1] / "suite" / "second_values.json"

Key = tuple[str, str, str]
"""Case, check and side."""


class AcceptError(ValueError):
    """The verdict cannot be accepted; one line with the reason."""


@dataclass(frozen=True)
class Accepted:
    """Accepted means, by case, check and side, each in the unit of its check."""

    values: Mapping[Key, float] = field(default_factory=dict)

    def attach(self, results: Iterable[CheckResult], *, fmu: bool = True) -> list[CheckResult]:
        """Return the results with their second values, where there are any.

        Those of an FMU whose values were not accepted (`fmu` False) have none.
        """
        return [
            replace(result, second=self._second(result))
            if fmu or result.side == "reference"
            else result
            for result in results
        ]

    def _second(self, result: CheckResult) -> Second | None:
        accepted = self.values.get((result.case, result.check, result.side))
        if accepted is None or result.measured is None:
            return None
        mean, scale = result.measured.mean, result.measured.scale
        drift = 0.0
        if mean != accepted:
            drift = abs(mean - accepted) / scale if scale > 0.0 else math.inf
        return Second(accepted, mean, drift, result.measured.resolution)


def load_accepted(file: Path = FILE) -> Accepted:
    """Read the accepted values; none where there is no file yet."""
    if not file.is_file():
        return Accepted()
    tree = json.loads(file.read_text(encoding="utf-8"))
    return Accepted(
        {
            (case, check, side): value
            for case, of_case in tree.items()
            for check, sides in of_case.items()
            for side, value in sides.items()
        }
    )


def accept(verdict: Verdict, file: Path = FILE) -> int:
    """Write the means of a verdict on the suite as the accepted ones, and give their number.

    Values of cases of the suite that the verdict does not hold stay; those of its cases are
    replaced, and those of cases that are no more go.

    Raises
    ------
    AcceptError
        The FMU is not held to the exact contract, a check failed against its truth, or a planted
        fault survived.
    """
    if not verdict.exact:
        raise AcceptError("only the exact block is accepted, and this FMU is another one")
    if verdict.kills is not None and not verdict.kills.passed:
        raise AcceptError("the suite did not catch every planted fault")
    wrong = [r for r in verdict.checks if not r.passed and r.not_applicable is None]
    if wrong:
        first = f"{wrong[0].case} / {wrong[0].check} ({wrong[0].side})"
        raise AcceptError(f"{len(wrong)} checks fail against their truth, first {first}")
    run = {result.case for result in verdict.checks}
    elsewhere = {case.id for case in load_cases()} - run
    if not any(case.id in run for case in load_cases() if case.law == COULOMB_NAME):
        # What is about no case is accepted from Coulomb's FMU.
        elsewhere.add("")
    kept = {key: v for key, v in load_accepted(file).values.items() if key[0] in elsewhere}
    new = {
        (r.case, r.check, r.side): r.measured.mean
        for r in verdict.checks
        if r.measured is not None and math.isfinite(r.measured.mean) and r.case not in elsewhere
    }
    write_whole(file, _text({**kept, **new}))
    return len(new)


def _text(values: Mapping[Key, float]) -> str:
    """Write one line a check, so that a change shows as the line it is."""
    tree: dict[str, dict[str, dict[str, float]]] = {}
    for case, check, side in sorted(values):
        tree.setdefault(case, {}).setdefault(check, {})[side] = values[case, check, side]
    cases = (_case(case, checks) for case, checks in tree.items())
    return "{\n" + ",\n".join(cases) + "\n}\n"


def _case(case: str, checks: Mapping[str, Mapping[str, float]]) -> str:
    lines: Sequence[str] = [f"  {json.dumps(c)}: {json.dumps(s)}" for c, s in checks.items()]
    return f" {json.dumps(case)}: {{\n" + ",\n".join(lines) + "\n }"
