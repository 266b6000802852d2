"""Records with a planted fault, and what sees it: the checks of a case and the invariants."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from stickslip_verification import CheckResult, load_case, load_invariants
from stickslip_verification.drive.exact import Exact, exact_motion, kept
from stickslip_verification.judge.checks import (
    EXACT_CONTRACT,
    Contract,
    applies,
    judge,
    judge_residual,
)
from stickslip_verification.model.verdict import Run, Series
from stickslip_verification.suite.cases import CASES_FOLDER, Case
from stickslip_verification.suite.invariants import ResidualInvariant

INVARIANTS = load_invariants().residuals


@dataclass
class Draft:
    outputs: dict[str, Series]
    initial: dict[str, float]


Fault = Callable[[Draft], None]


@cache
def named(name: str) -> Case:
    return load_case(CASES_FOLDER / f"{name}.toml")


@cache
def exact_of(name: str) -> Exact:
    return kept(exact_motion, named(name))


@cache
def believed(name: str, *values: tuple[str, float]) -> Run:
    case = named(name)
    return exact_motion(replace(case, parameters={**case.parameters, **dict(values)})).record


@cache
def invariants_of(name: str) -> tuple[ResidualInvariant, ...]:
    return tuple(
        invariant
        for invariant in INVARIANTS
        if invariant.holds_for(named(name).law) and applies(invariant, named(name), exact_of(name))
    )


def planted(record: Run, *faults: Fault) -> Run:
    copies = {name: np.array(samples) for name, samples in record.outputs.items()}
    draft = Draft(copies, dict(record.initial))
    for fault in faults:
        fault(draft)
    return Run(record.times, draft.outputs, draft.initial, record.messages)


def judged(name: str, record: Run, contract: Contract = EXACT_CONTRACT) -> dict[str, CheckResult]:
    case, exact = named(name), exact_of(name)
    return {
        invariant.id: judge_residual(invariant, case, contract, exact, record)
        for invariant in invariants_of(name)
    }


def seen(name: str, record: Run, contract: Contract = EXACT_CONTRACT) -> set[str]:
    results = judged(name, record, contract).items()
    return {id_ for id_, r in results if not r.passed and r.not_applicable is None}


def checked(name: str, record: Run, contract: Contract = EXACT_CONTRACT) -> dict[str, CheckResult]:
    case, exact = named(name), exact_of(name)
    return {check.id: judge(case, check, contract, exact, record) for check in case.checks}


def failures(name: str, record: Run) -> dict[str, CheckResult]:
    return {check: result for check, result in checked(name, record).items() if not result.passed}


def value(name: str, number: float, at: int) -> Fault:
    return lambda draft: draft.outputs[name].__setitem__(at, number)


def at_start(name: str, number: float) -> Fault:
    return lambda draft: draft.initial.__setitem__(name, number)


def scaled(name: str, factor: float) -> Fault:
    def fault(draft: Draft) -> None:
        draft.outputs[name] *= factor
        draft.initial[name] *= factor

    return fault


def shown(name: str, samples: Callable[[Mapping[str, Series]], Series]) -> Fault:
    return lambda draft: draft.outputs.__setitem__(name, samples(draft.outputs))


def lagging(name: str) -> Fault:
    def fault(draft: Draft) -> None:
        draft.outputs[name] = np.append(draft.initial[name], draft.outputs[name][:-1])

    return fault


def without(name: str) -> Fault:
    def fault(draft: Draft) -> None:
        del draft.outputs[name], draft.initial[name]

    return fault
