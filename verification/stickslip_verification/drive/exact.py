"""The exact motion of a case: the truth, followed in high precision and rounded once."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip_verification import truth
from stickslip_verification.model.events import Transition
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run, Series
from stickslip_verification.suite.cases import Case, follow
from stickslip_verification.suite.tolerances import Facts, facts_of


@dataclass(frozen=True)
class Phase:
    """A stick or a slip: its beginning [s], the slips completed before it, whether it sticks."""

    begin: float
    slips: int
    sticks: bool


@dataclass(frozen=True)
class Exact:
    """The exact motion of a case.

    Attributes
    ----------
    record
        Its samples, rounded to double once.
    start
        Every value at the start, the defaults included (SI).
    event_times
        Times of its transitions [s].
    facts
        What the tolerances take from it.
    phases
        Its sticks and slips in order of time.
    """

    record: Run
    start: Mapping[str, float]
    event_times: Sequence[float]
    facts: Facts
    phases: Sequence[Phase]


def exact_motion(case: Case) -> Exact:
    """Compute the exact motion of a case in high precision, rounded to double once."""
    run = follow(case.parameters, case.steps, case.law)
    return Exact(
        record=Run(
            times=np.array(case.times),
            outputs=sampled(run),
            initial={name: float(run.initial[name]) for name in OUTPUT_NAMES},
        ),
        start=case.start,
        event_times=[float(event.time) for event in run.events],
        facts=facts_of(run),
        phases=list(_phases(run)),
    )


def sampled(run: truth.Run) -> dict[str, Series]:
    """Return the outputs of an exact run as doubles."""
    return {
        name: np.array([float(sample[name]) for sample in run.samples]) for name in OUTPUT_NAMES
    }


def _phases(run: truth.Run) -> Iterator[Phase]:
    slips = 0
    yield Phase(0.0, slips, bool(run.initial["sticking"]))
    for event in run.events:
        slips += event.kind != Transition.BREAK_AWAY
        yield Phase(float(event.time), slips, event.mode == 0)
