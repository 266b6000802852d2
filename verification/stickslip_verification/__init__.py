"""Verification of the stick-slip block: exact truth, cases as data, two sides, one verdict.

`load_cases` reads the cases, `verify` judges an FMU and the reference on them, `write_json` writes
the verdict, `prove` runs the random sets. Names are resolved when they are first used, so that
importing this package costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip_verification.cases import Case, CaseError, load_cases
    from stickslip_verification.fmu_file import FmuError
    from stickslip_verification.proofs import ProofResult, prove
    from stickslip_verification.report import as_json, write_json
    from stickslip_verification.run import verify
    from stickslip_verification.verdict import CheckResult, Verdict

_HOME = {
    "Case": "cases",
    "CaseError": "cases",
    "CheckResult": "verdict",
    "FmuError": "fmu_file",
    "ProofResult": "proofs",
    "Verdict": "verdict",
    "as_json": "report",
    "load_cases": "cases",
    "prove": "proofs",
    "verify": "run",
    "write_json": "report",
}

__all__ = [
    "Case",
    "CaseError",
    "CheckResult",
    "FmuError",
    "ProofResult",
    "Verdict",
    "as_json",
    "load_cases",
    "prove",
    "verify",
    "write_json",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
