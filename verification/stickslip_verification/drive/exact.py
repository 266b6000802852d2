"""The exact motion of a case: the truth, followed in high precision and rounded once."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stickslip_verification import truth
from stickslip_verification.model.events import Event, Transition
from stickslip_verification.model.quantities import OUTPUT_NAMES
from stickslip_verification.model.run import Run
from stickslip_verification.suite.cases import Case, follow
from stickslip_verification.suite.tolerances import Facts, facts_of


@dataclass(frozen=True)
class Exact:
    """The exact motion of a case: its samples, rounded to double once, and its transitions.

    ``start`` has every value at the start (SI), ``facts`` is what the tolerances take from it.
    """

    record: Run
    start: Mapping[str, float]
    events: Sequence[Event]
    facts: Facts

    @property
    def event_times(self) -> Sequence[float]:
        """Times of the transitions [s]."""
        return [event.time for event in self.events]


def exact_motion(case: Case) -> Exact:
    """Compute the exact motion of a case in high precision, rounded to double once."""
    run = follow(case.parameters, case.steps, case.law)
    return Exact(
        record=record_of(case, run),
        start=case.start,
        events=[
            Event(float(e.time), Transition(e.kind), e.mode, float(e.x), float(e.z))
            for e in run.events
        ],
        facts=facts_of(run),
    )


def record_of(case: Case, run: truth.Run) -> Run:
    """Return the samples of an exact run of a case, rounded to double."""
    return Run(
        times=np.array(case.times),
        outputs={n: np.array([float(sample[n]) for sample in run.samples]) for n in OUTPUT_NAMES},
        initial={n: float(run.initial[n]) for n in OUTPUT_NAMES},
    )
