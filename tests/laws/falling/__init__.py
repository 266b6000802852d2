"""Kinetic friction that falls linearly with speed, a law that only the tests know."""

from typing import NamedTuple


class _Sides(NamedTuple):
    block: str
    reference: str
    truth: str


FALLING = _Sides(
    block="tests.laws.falling.block:LAW",
    reference="tests.laws.falling.reference:LAW",
    truth="tests.laws.falling.truth:LAW",
)
