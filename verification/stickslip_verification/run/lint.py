"""Lint of the suite: rules of its data files beyond their schemas, and names that are unused."""

import json
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from stickslip_verification.drive.exact import Exact, exact_motion
from stickslip_verification.drive.kept import kept
from stickslip_verification.drive.masters import RUNS
from stickslip_verification.drive.probes.table import PROBES
from stickslip_verification.judge.metrics import METRICS
from stickslip_verification.model.formulas import FORMULAS
from stickslip_verification.model.quantities import QUANTITIES
from stickslip_verification.model.verdict import Measure
from stickslip_verification.suite.case_file import CASES_FOLDER, CaseError, load_case
from stickslip_verification.suite.cases import Case, Check
from stickslip_verification.suite.faults import (
    Mutant,
    MutantError,
    load_mutants,
)
from stickslip_verification.suite.invariants import InvariantError, Invariants, load_invariants
from stickslip_verification.suite.tolerances import ZERO, Facts

THEORY = Path(__file__).parents[3] / "docs" / "theory.md"
"""Where the equations stand, in a working copy; an installed suite does not carry it."""

VAGUE = ("somehow", "good enough", "seems", "for now", "should work", "empirical", "tuned", "magic")
"""Words that are no reason."""

SHORTEST = 20
"""Characters below which a reason says nothing."""


def lint(folder: Path = CASES_FOLDER) -> list[str]:
    """Return the findings, one line each; none if the suite is sound.

    Parameters
    ----------
    folder
        Where the cases are. Invariants and planted faults are those of the suite.
    """
    findings: list[str] = []
    cases = []
    for file in sorted(folder.glob("*.toml")):
        try:
            cases.append(load_case(file))
        except CaseError as error:
            findings.append(str(error))
    try:
        invariants, mutants = load_invariants(), load_mutants()
    except (InvariantError, MutantError) as error:
        return [*findings, str(error)]
    motions = {case.file: kept(exact_motion, case) for case in cases}
    findings += _ids(cases)
    findings += _motions(cases, motions)
    findings += _reasons(cases, invariants)
    findings += _sources(cases, invariants)
    findings += _unused(cases, invariants)
    findings += _mutants(cases, invariants, mutants)
    return findings


def _ids(cases: Sequence[Case]) -> Iterator[str]:
    counted = Counter(case.id for case in cases)
    yield from (f"{name}: {n} cases have this id" for name, n in counted.items() if n > 1)
    for case in cases:
        if case.file.stem != case.id:
            yield f"{case.file.name}: its id is {case.id!r}, not the name of the file"
    for name, n in Counter(case.title for case in cases).items():
        if n > 1:
            yield f"{n} cases have the title {name!r}"


def _motions(cases: Sequence[Case], motions: Mapping[Path, Exact]) -> Iterator[str]:
    """Hold what a case states of its exact motion against it."""
    for case in cases:
        exact = motions[case.file]
        happens = exact.facts
        if case.facts is None:
            zero = [check.quantity for check in case.checks if check.because["fmu"] == ZERO]
            yield (
                f"{case.id}: motion is missing, so the exact motion is followed at each loading; "
                f"write {_as_toml(replace(happens, zero=frozenset(zero)))}"
            )
            continue
        looked_at = {check.quantity for check in case.checks if check.measure == Measure.OF_SCALE}
        under_way = int(exact.record.outputs["mode"][-1] != 0)
        if not 0 <= case.facts.slips - happens.slips <= under_way:
            or_more = f" or {happens.slips + 1}" if under_way else ""
            yield f"{case.id}: motion.slips = {case.facts.slips}; it is {happens.slips}{or_more}"
        if case.facts.reversals != happens.reversals:
            stated = case.facts.reversals
            yield f"{case.id}: motion.reversals = {stated}; it is {happens.reversals}"
        for name in sorted(case.facts.zero - happens.zero):
            yield f"{case.id}: motion.zero: {name} is not zero throughout"
        for name in sorted(happens.zero & looked_at):
            yield f"{case.id}: motion.zero: {name} is zero throughout and not named"


def _as_toml(facts: Facts) -> str:
    parts = [f"slips = {facts.slips}"]
    if facts.reversals:
        parts.append(f"reversals = {facts.reversals}")
    if facts.zero:
        parts.append(f"zero = [{', '.join(json.dumps(name) for name in sorted(facts.zero))}]")
    return f"motion = {{ {', '.join(parts)} }}"


def _reasons(cases: Sequence[Case], invariants: Invariants) -> Iterator[str]:
    for case, check in _checks(cases):
        for side, text in check.because.items():
            yield from _reason(f"{case.id} / {check.id}: because.{side}", text)
    for invariant in invariants:
        yield from _reason(f"{invariant.id}: means", invariant.means)
        yield from _reason(f"{invariant.id}: look", invariant.look)
        if invariant.stays:
            yield from _reason(f"{invariant.id}: stays", invariant.stays)
        because = getattr(invariant, "because", {})
        texts = {"": because} if isinstance(because, str) else because
        for side, text in texts.items():
            yield from _reason(f"{invariant.id}: because {side}".rstrip(), text)


def _reason(where: str, text: str) -> Iterator[str]:
    if len(text) < SHORTEST:
        yield f"{where}: {text!r} says too little"
    for word in VAGUE:
        if re.search(rf"\b{word}\b", text, re.IGNORECASE):
            yield f"{where}: {word!r} is no reason"


def _sources(cases: Sequence[Case], invariants: Invariants) -> Iterator[str]:
    if not THEORY.is_file():
        return
    numbers = {int(n) for n in re.findall(r"\\tag\{(\d+)\}", THEORY.read_text(encoding="utf-8"))}
    for case, check in _checks(cases):
        if check.truth.source not in numbers:
            yield f"{case.id} / {check.id}: docs/theory.md has no equation ({check.truth.source})"
    for invariant in invariants:
        if invariant.source not in numbers:
            yield f"{invariant.id}: docs/theory.md has no equation ({invariant.source})"


def _unused(cases: Sequence[Case], invariants: Invariants) -> Iterator[str]:
    checks = [check for _, check in _checks(cases)]
    quantities = {check.quantity for check in checks}
    quantities |= {invariant.quantity for invariant in invariants.agreements}
    quantities |= {invariant.quantity for invariant in invariants.orders}
    formulas = {check.truth.formula for check in checks if check.truth.formula is not None}
    # What the designers' slip time is held against is the difference, not the formula itself.
    formulas.add("half_period")
    families: tuple[tuple[str, Collection[str], set[str]], ...] = (
        ("quantity", QUANTITIES, quantities),
        ("formula", FORMULAS, formulas),
        ("metric", METRICS, {invariant.metric for invariant in invariants.residuals}),
        ("run", RUNS, {invariant.run for invariant in invariants.runs}),
        ("probe", PROBES, {invariant.probe for invariant in invariants.probes}),
    )
    for what, known, used in families:
        for name in sorted(set(known) - used):
            yield f"{what} {name}: nothing uses it"
        for name in sorted(used - set(known)):
            yield f"{what} {name}: there is no such {what}"
    known_cases = {case.id for case in cases}
    for order in invariants.orders:
        for name in order.cases:
            if name not in known_cases:
                yield f"{order.id}: there is no case {name}"


def _mutants(
    cases: Sequence[Case], invariants: Invariants, mutants: Sequence[Mutant]
) -> Iterator[str]:
    checks = {check.id for _, check in _checks(cases)} | {invariant.id for invariant in invariants}
    for mutant in mutants:
        for name in mutant.detected_by:
            if name not in checks:
                yield f"planted fault {mutant.id}: there is no check {name}"


def _checks(cases: Iterable[Case]) -> Iterator[tuple[Case, Check]]:
    for case in cases:
        for check in case.checks:
            yield case, check
