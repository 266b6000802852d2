"""Verification of the stick-slip block: exact truth, cases as data, two sides, one verdict.

`load_cases` reads the cases, `verify` judges an FMU and the reference on them, `write_report`
writes what came out, `accept` keeps it as second values, `lint` checks the suite itself, `prove`
runs the random sets; `score` and `claims` are packages of their own. Names are resolved when they
are first used, so that importing this package costs nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from stickslip_verification.lazy import face

if TYPE_CHECKING:
    from stickslip_verification.baseline import Baseline, BaselineError, compare, read_baseline
    from stickslip_verification.cases import Case, load_case, load_cases
    from stickslip_verification.catalogue import Meaning, meanings
    from stickslip_verification.experiment import CaseError
    from stickslip_verification.fmu import FmuError, NameMap, NamesError, load_names
    from stickslip_verification.judging.second import AcceptError, accept
    from stickslip_verification.laws import LawError, load_laws
    from stickslip_verification.linter import lint
    from stickslip_verification.margins import margin
    from stickslip_verification.mutants import Mutant, MutantError, load_mutant, load_mutants
    from stickslip_verification.proofs import ProofResult, prove
    from stickslip_verification.report import (
        ClaimSection,
        PdfUnavailableError,
        as_json,
        check_pdf,
        course_tolerances,
        draw_case,
        packed_report,
        render,
        write_json,
        write_pdf,
        write_report,
    )
    from stickslip_verification.suite.verify import verify
    from stickslip_verification.verdict import CheckResult, KillMatrix, Verdict

_HOME = {
    "margin": "margins",
    "Meaning": "catalogue",
    "KillMatrix": "verdict",
    "draw_case": "report",
    "course_tolerances": "report",
    "check_pdf": "report",
    "ClaimSection": "report",
    "AcceptError": "judging.second",
    "Baseline": "baseline",
    "BaselineError": "baseline",
    "Case": "cases",
    "CaseError": "experiment",
    "CheckResult": "verdict",
    "FmuError": "fmu",
    "LawError": "laws",
    "Mutant": "mutants",
    "MutantError": "mutants",
    "NameMap": "fmu",
    "NamesError": "fmu",
    "PdfUnavailableError": "report",
    "ProofResult": "proofs",
    "Verdict": "verdict",
    "accept": "judging.second",
    "as_json": "report",
    "compare": "baseline",
    "lint": "linter",
    "load_case": "cases",
    "load_cases": "cases",
    "load_laws": "laws",
    "load_mutant": "mutants",
    "load_mutants": "mutants",
    "load_names": "fmu",
    "packed_report": "report",
    "meanings": "catalogue",
    "prove": "proofs",
    "read_baseline": "baseline",
    "render": "report",
    "verify": "suite.verify",
    "write_json": "report",
    "write_pdf": "report",
    "write_report": "report",
}

__all__ = [
    "AcceptError",
    "Baseline",
    "BaselineError",
    "Case",
    "CaseError",
    "CheckResult",
    "ClaimSection",
    "FmuError",
    "KillMatrix",
    "LawError",
    "Meaning",
    "Mutant",
    "MutantError",
    "NameMap",
    "NamesError",
    "PdfUnavailableError",
    "ProofResult",
    "Verdict",
    "accept",
    "as_json",
    "check_pdf",
    "compare",
    "course_tolerances",
    "draw_case",
    "lint",
    "load_case",
    "load_cases",
    "load_laws",
    "load_mutant",
    "load_mutants",
    "load_names",
    "margin",
    "meanings",
    "packed_report",
    "prove",
    "read_baseline",
    "render",
    "verify",
    "write_json",
    "write_pdf",
    "write_report",
]

__getattr__, __dir__ = face(__name__, _HOME)
