"""Verdicts made by hand: an axis that judders, a rigid one, an unstable one."""

import math
from dataclasses import replace
from functools import cache

from stickslip_design.axis import Assumed, Axis, Demand, Drive, Friction, low_pass, notch
from stickslip_design.loop.hunting import Hunting
from stickslip_design.loop.response import open_loop
from stickslip_design.loop.stability import gain_limits, swing
from stickslip_design.record import record
from stickslip_design.verdict import AxisCure, OperatingPoint, Verdict
from stickslip_ref import Interval, Kind, Regime, StickSlip

JUMPS = (1.387e-5, 1.844e-5, 2.931e-5)
FEEDS = (1 / 30e3, 5e-4, 1.2e-3, 5e-3, 0.5)
DRIVE = Drive(
    inertia=6e-3 * (2.0 * math.pi / 0.01) ** 2, d=1000.0, K_v=25.0, bandwidth=300.0,
    T_n=4.0 / 300.0, T_s=250e-6, F_max=12e3, resolution_motor=1e-8, resolution_table=1e-7,
)  # fmt: skip
AXIS = Axis(
    name="Feed axis of a milling machine", m=500.0, k=40e6, c=4000.0,
    friction=Friction(mu_s=0.20, mu_k=0.15), drive=DRIVE,
    demand=Demand(feeds=FEEDS, acceleration=0.1, largest_jump=5e-6, largest_error=5e-6),
    spread={"friction.mu_s": 0.02, "axis.stiffness": 4e6},
)  # fmt: skip


def point(
    feed: float, critical: float, jump: float | None = None, from_rest: bool | None = None
) -> OperatingPoint:
    cycle = None if jump is None else StickSlip(jump, jump / feed)
    kind: Kind = "even" if jump is None else "sticks"
    return OperatingPoint(
        regime=Regime(feed, 0.05, 60.0, (), cycle, kind, 0.1),
        margin=feed / critical if critical else math.inf, after_start=from_rest,
        simplified_jump=1.226e-5, simplified_frequency=feed / 1.226e-5,
    )  # fmt: skip


CYCLE = StickSlip(JUMPS[0], JUMPS[0] / FEEDS[0], True)
HUNTS = Regime(FEEDS[0], 0.05, 60.0, (), CYCLE, "sticks", math.inf)
EVEN = "no jump at the slowest feed"
CURES = (
    AxisCure("faster", "feeds", "m/s", FEEDS[0], 1.55e-3, 2.5, EVEN),
    AxisCure("less gap", "mu_s", "1", 0.20, 0.1661, 3.1, EVEN, "mu_k"),
    AxisCure("lighter", "mass", "kg", 500.0, 80.0, 6.25, EVEN),
    AxisCure("stiffer", "stiffness", "N/m", 40e6, 280e6, 7.0, "a jump that is allowed",
             "zeta, the damping ratio: c grows with the root of the stiffness",
             "the screw of 100 N/um takes 41 % off the critical feed"),
    AxisCure("dead band", "dead_band", "m", 5e-5, 2e-3, 60.0, "no hunting"),
    AxisCure("more damping", "damping", "N.s/m", 4000.0, None, math.inf, EVEN,
             "", "none does: the bandwidth bounds it"),
)  # fmt: skip


@cache
def juddering() -> Verdict:
    """Return the axis of docs/feed-axis.md, asked at five feeds."""
    critical = 1.5506e-3
    starts = (True, True, False, None, None)
    first, *points = (
        point(feed, critical, jump, from_rest)
        for feed, jump, from_rest in zip(FEEDS, (*JUMPS, None, None), starts, strict=True)
    )
    return Verdict(
        axis=AXIS, stable=True, cycle=(Interval(0.0, critical, "none", "grazing"),), unstable=(),
        critical_feed=critical, critical_range=(1.212e-3, 1.927e-3),
        rigid_critical_feed=3.947e-3, estimated_critical_feed=1.604e-3,
        simplified_critical_feed=4.612e-3, from_rest=9.903e-4, sliding=swing(AXIS),
        stuck=swing(AXIS, sliding=False), gains=gain_limits(AXIS),
        points=(replace(first, regime=HUNTS), *points),
        hunting=Hunting(1.3592e-5, 0.85136, 6.8018e-6), cures=CURES,
        responses=tuple(
            open_loop(AXIS, cut, sliding=on)
            for cut in ("force", "position") for on in (True, False)
        ),
        before=record(AXIS, 5e-4, 0.3), after=record(AXIS, 2e-3, 0.3),
        sentence="At 2 mm/min this axis jumps 13.9 µm, 2.4 times a second; from 1.55 mm/s on it "
        "cannot. Smallest change: raise the slowest feed to 1.55 mm/s.",
        unanswered=("Reversal of the feed: the jumps are those of one direction.",) * 2,
    )  # fmt: skip


@cache
def rigid() -> Verdict:
    axis = replace(
        AXIS, name="Slide of a grinder", drive=None, demand=Demand(feeds=FEEDS[1:4]), spread={}
    )
    critical = 3.947e-3
    return replace(
        juddering(), axis=axis, critical_feed=critical, critical_range=(critical, critical),
        cycle=(Interval(0.0, critical, "none", "grazing"),),
        rigid_critical_feed=critical, estimated_critical_feed=None, from_rest=None, sliding=None,
        stuck=None, gains=None, hunting=None, responses=(), cures=CURES[:3],
        points=tuple(map(point, FEEDS[1:4], [critical] * 3, (2.1e-5, 3.3e-5, None))),
        sentence="At 30 mm/min this axis jumps 21 µm; from 3.95 mm/s on it cannot.",
    )  # fmt: skip


@cache
def unstable() -> Verdict:
    axis = replace(AXIS, name="Axis, K_v = 100 1/s", drive=replace(DRIVE, K_v=100.0))
    return replace(
        juddering(), axis=axis, stable=False, critical_feed=math.nan,
        cycle=(), critical_range=(math.nan, math.nan), estimated_critical_feed=None, from_rest=None,
        sliding=swing(axis), stuck=swing(axis, sliding=False), gains=gain_limits(axis), points=(),
        hunting=None, cures=(), before=None, after=None,
        responses=tuple(open_loop(axis, cut) for cut in ("force", "position")),
        sentence="The loop is unstable: K_v = 100 1/s is above the 72.2 1/s that it bears.",
    )  # fmt: skip


@cache
def large() -> Verdict:
    """Return what fills a report: many feeds, cures with notes, assumptions and filters."""
    filters = (low_pass(800.0), low_pass(600.0, 0.7), notch(120.0, 0.5, 0.1))
    why = "not on the data sheet: a usual value of such drives"
    assumed = (Assumed("drive.velocity_feedforward_1", "1 ms", why),) * 10
    drive = replace(DRIVE, filters=filters, lag=2e-4)
    axis = replace(AXIS, name="<b>X</b> & Y", drive=drive, assumed=assumed)
    before = juddering()
    return replace(
        before, axis=axis, points=before.points[:4] * 3, cures=CURES * 3,
        unanswered=before.unanswered * 4, sentence=before.sentence * 2,
    )  # fmt: skip


ALL = {each.__name__: each for each in (juddering, rigid, unstable, large)}
