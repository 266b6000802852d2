"""Verdicts on an axis that judders, on a rigid one, on an unstable one, and what fills a report."""

from dataclasses import replace
from functools import cache

from stickslip_design.axis import Assumed, Filter, axis_file_of, example
from stickslip_design.study import design
from stickslip_design.verdict import Verdict
from tests.design.axes import RIGID, driven

FILE = (
    example()
    .replace('"40 N/um"', '"40 N/um ± 4 N/um"')
    .replace("mu_s = 0.20", 'mu_s = "0.20 ± 0.02"')
    .replace('"0.5 mm/s", "2 mm/s", "5', '"0.5 mm/s", "0.8 mm/s", "1.2 mm/s", "5 mm/s", "500')
    .replace("[demand]", '[demand]\nlargest_jump = "5 um"\nlargest_error = "5 um"')
)


@cache
def juddering() -> Verdict:
    """Return the verdict on the axis of docs/feed-axis.md, asked at five feeds."""
    return design(axis_file_of(FILE))


@cache
def rigid() -> Verdict:
    return design(RIGID)


@cache
def unstable() -> Verdict:
    return design(driven(K_v=100.0))


@cache
def large() -> Verdict:
    before = juddering()
    assert before.axis.drive is not None
    corner = Filter("low pass", 800.0)
    filters = (corner, replace(corner, damping=0.7), Filter("notch", 120.0, 0.5, 0.1))
    assumed = Assumed("drive.velocity_feedforward_1", "1 ms", "not on the data sheet: usual")
    drive = replace(before.axis.drive, filters=filters, lag=2e-4)
    axis = replace(before.axis, name="<b>X</b> & Y", drive=drive, assumed=(assumed,) * 10)
    return replace(
        before, axis=axis, points=before.points[:4] * 3, unanswered=before.unanswered * 2,
        sentence=before.sentence * 2,
    )  # fmt: skip


ALL = {each.__name__: each for each in (juddering, rigid, unstable, large)}
