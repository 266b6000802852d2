"""What is said of random axes is what their motion, followed without events, leads to."""

import math
from pathlib import Path

import numpy as np
import pytest

from stickslip_design.axis import read_axis_file
from stickslip_design.loop.critical import regime_of
from stickslip_design.loop.stability import is_stable
from tests.judge.axes import Motion, Seen, Start, quantity, seen, steep
from tests.judge.draws import axis, write

STARTS: tuple[Start, ...] = ("rest", "jumps", "near")
AMPLITUDE = 0.03
"""Of a swing, relative: a swing that is modulated, looked at for other times by both sides."""
FREQUENCY = 0.01
"""Of a swing, relative: as the amplitude."""
JUMP = 0.03
"""Of a jump, relative: samples cut the sticks of a servo axis unevenly."""


def disagreements(number: int, folder: Path) -> list[str]:
    drawn = axis(number)
    stated = read_axis_file(write(drawn, folder)).axis()
    wrong: list[str] = []
    if stated.drive is not None and not is_stable(stated):
        return wrong
    for feed in drawn["demand"]["feeds"]:
        said = regime_of(stated, quantity(feed))
        ends = {start: seen(drawn, feed, start) for start in STARTS}
        if ends["rest"].kind not in ("unsettled", said.from_rest):
            wrong.append(f"{feed}: from rest {ends['rest'].kind}, said {said.from_rest}")
        if ends["near"].kind == "even" and not said.even:
            wrong.append(f"{feed}: even motion lasts")
        wrong += [f"{feed}: {end}" for end in ends.values() if not _said(end, said.kinds)]
        for end in ends.values():
            if end.kind == "swings" and not any(
                abs(swing.amplitude / end.amplitude - 1.0) < AMPLITUDE
                and abs(swing.frequency / end.frequency - 1.0) < FREQUENCY
                for swing in said.swings
            ):
                wrong.append(f"{feed}: {end}, said {said.swings}")
        jump = 0.0 if said.stick_slip is None else said.stick_slip.jump
        rest = ends["rest"]
        compared = jump > 0.0 and rest.kind == "sticks" and rest.repeats
        # Of jumps that take turns the longest may be said.
        near = (abs(jump / seen_jump - 1.0) < JUMP for seen_jump in (rest.jump, rest.longest))
        if compared and not any(near):
            wrong.append(f"{feed}: jumps {rest.jump:.3g} m, said {jump:.3g} m")
    return wrong


def _said(end: Seen, kinds: tuple[str, ...]) -> bool:
    return end.kind in ("unsettled", *kinds)


@pytest.mark.gate
@pytest.mark.parametrize("number", [117, 179, 185])
def test_a_sample_of_random_axes_does_what_is_said(number: int, tmp_path: Path) -> None:
    assert disagreements(number, tmp_path) == []


SECOND_SWING = pytest.mark.xfail(
    reason="swings by 0.619 and by 0.768 last, and the second, 1 % off even motion, is not said",
    strict=True,
)


@pytest.mark.soak
@pytest.mark.parametrize(
    "number", [pytest.param(n, marks=[SECOND_SWING] * (n == 43)) for n in range(300)]
)
def test_random_axes_do_what_is_said(number: int, tmp_path: Path) -> None:
    assert disagreements(number, tmp_path) == []


@pytest.mark.parametrize(
    ("number", "width"),
    [*((n, 1e-4) for n in (0, 3, 4, 7, 13, 21)), *((n, 1e-6) for n in (0, 4, 16, 21))],
)
def test_steps_of_the_judge_give_what_a_stiff_solver_gives(number: int, width: float) -> None:
    drawn = axis(number)
    # The faster feed: in long sticks the table creeps by steep friction, and breaks away late.
    feed = drawn["demand"]["feeds"][1]
    steps, stiff = Motion(drawn, feed, "jumps"), Motion(drawn, feed, "jumps")
    apart, springs = [], []
    for z, _ in steep(stiff, math.ceil(20.0 / steps.w / steps.T_s), width):
        steps.advance(1)
        apart.append(abs(z - steps.state[0]))
        springs.append(z)
    # Friction falls from static to kinetic over 60 widths, 0.6 % of the feed.
    assert max(apart) < 0.005 * np.ptp(springs)


def test_the_command_reads_axis_files_as_the_judge_does(tmp_path: Path) -> None:
    for number in range(10):
        drawn = axis(number)
        own, read = Motion(drawn, 1.0, "rest"), read_axis_file(write(drawn, tmp_path)).axis()
        pairs = [(own.m, read.m), (own.k, read.k), (own.c, read.c), (own.along, read.along)]
        if read.drive:
            drive = read.drive
            pairs += [(own.m_d, drive.inertia), (own.K_p, drive.inertia * drive.bandwidth)]
            pairs += [(own.T_n, drive.T_n), (own.dry, drive.dry), (own.d, drive.d)]
        for judged, said in pairs:
            # Rounding of what is multiplied.
            assert judged == pytest.approx(said, rel=1e-12)
