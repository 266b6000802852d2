"""The truth's march by Taylor series, and what a friction law of the truth brings to it.

The march is held against closed forms: Coulomb's, which the truth solves on another way, and those
of laws that make the motion another linear system. Fifty digits are promised; a tolerance of 1e-45
leaves five for what a shallow end of a slip amplifies.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

import pytest

from stickslip_verification import truth
from stickslip_verification.truth import FrictionLaw, Numbers, Series
from stickslip_verification.truth.parameters import high_precision
from tests.verification.test_truth_against_taylor import _draw

MP = high_precision(50)
TOLERANCE = MP.mpf("1e-45")

Real = Any


class _Marched(FrictionLaw):
    """Coulomb's law, told as a general one."""

    def kinetic(self, n: Numbers, speed: Series, state: Sequence[Series]) -> Series:
        return Series(speed.context, [n.F_k])


def _compare(
    one: truth.Run, other: truth.Run, tolerance: Real = TOLERANCE, leave: Sequence[str] = ()
) -> None:
    """Assert equal events, and equal outputs to the tolerance of their own scale."""
    assert [(e.kind, e.mode) for e in one.events] == [(e.kind, e.mode) for e in other.events]
    for name in one.initial:
        pairs = [(a[name], b[name]) for a, b in zip(one.samples, other.samples, strict=True)]
        largest = max(abs(a) for a, _ in pairs)
        for a, b in pairs:
            assert abs(a - b) <= tolerance * largest, (name, a, b)


@pytest.mark.parametrize("seed", range(24))
def test_march_is_the_closed_form_on_any_sequence(seed: int) -> None:
    """Damping under, at and over the critical, changes of everything, reversals: 45 digits."""
    values, steps = _draw(random.Random(1000 + seed))
    _compare(truth.run(values, steps), truth.run(values, steps, law=_Marched()))
