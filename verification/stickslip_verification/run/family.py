"""Writes how accurate honest solvers are in each case: ``python -m`` with the name of this module.

It takes ten minutes of a processor. A test holds three of the solvers against the file.
"""

import sys
from concurrent.futures import ProcessPoolExecutor

from stickslip_verification.drive import workers
from stickslip_verification.drive.solvers import SOLVERS
from stickslip_verification.judge.accuracy import DIVERGED, Ruler
from stickslip_verification.model.verdict import Klass
from stickslip_verification.run.verify import LONGEST_OF_ANY
from stickslip_verification.suite.case_file import load_cases
from stickslip_verification.suite.cases import Case
from stickslip_verification.suite.family import FILE, long_cases


def main() -> None:
    """Write the file anew."""
    physics = [case for case in load_cases() if case.klass == Klass.PHYSICS]
    cases = [case for case in physics if case.stop_time <= LONGEST_OF_ANY]
    lines = [
        "# Delta of honest solvers in each case, for judge/accuracy.py; run/family.py made it."
    ]
    lines += ["long = [", *(f'    "{name}",' for name in sorted(long_cases())), "]"]
    lines += ["", "# A column for each of drive/solvers.py.", "[deltas]"]
    with ProcessPoolExecutor() as pool:
        for case, deltas in zip(cases, pool.map(_deltas, cases), strict=True):
            lines.append(f'"{case.id}" = [{", ".join(f"{delta:.1e}" for delta in deltas)}]')
            print(lines[-1], file=sys.stderr, flush=True)
    FILE.write_text("\n".join(lines) + "\n", "utf-8")


def _deltas(case: Case) -> list[float]:
    ruler = Ruler(workers.exact(case), workers.spreads(case))
    runs = [solver.run(case) for solver in SOLVERS.values()]
    return [min(ruler.deviation(run).delta, DIVERGED) for run in runs]


if __name__ == "__main__":
    main()
