"""The linear motion over a step, exactly: docs/theory.md (3), for many steps at once.

In the time ``tau = w t`` the extension z, measured from where the slip has its balance, obeys
``z'' + 2 zeta z' + z = 0``. Its transition matrix is summed as a power series and squared up, in
the widest floating-point numbers there are, so that its own rounding is never what is seen.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip_verification.judge.metrics.course import Course, Mask
from stickslip_verification.model.run import Series

Wide = NDArray[np.longdouble]

_PRODUCT = "ijn,jkn->ikn"
_TERMS = 24
_LARGEST = 0.25
"""A series of so many terms is exact to 1e-30 for matrices of this norm."""


@dataclass(frozen=True)
class State:
    """z [m] and x_dot [m/s] of each step, shape ``(n,)``."""

    z: Wide
    x_dot: Wide


@dataclass(frozen=True)
class Slips:
    """The equation of slip of some steps: (3). Arrays of shape ``(n,)``, SI units."""

    m: Wide
    k: Wide
    c: Wide
    v: Wide
    drive: Wide
    """F_ext less kinetic friction, ``F_ext - s mu_k N`` [N]."""

    @property
    def turning_rate(self) -> Wide:
        """Angular frequency [rad/s]; zero where damping lets nothing swing."""
        square = self.k / self.m - (self.c / (2.0 * self.m)) ** 2
        return np.asarray(np.sqrt(np.maximum(square, 0.0)))

    def acceleration(self, state: State) -> Wide:
        """Return x_ddot [m/s2]."""
        return np.asarray((self.k * state.z + self.drive - self.c * state.x_dot) / self.m)

    def jerk(self, state: State) -> Wide:
        """Return the rate of x_ddot [m/s3]."""
        rate = self.k * (self.v - state.x_dot) - self.c * self.acceleration(state)
        return np.asarray(rate / self.m)

    def move(self, state: State, duration: Series | Wide) -> State:
        """Return the state `duration` [s] later, if the slip lasts."""
        w = np.sqrt(self.k / self.m)
        centre = (self.c * self.v - self.drive) / self.k
        y, rate = state.z - centre, (self.v - state.x_dot) / w
        a, b, c, d = _transition(w * np.asarray(duration, np.longdouble), self.c / (self.m * w))
        return State(centre + a * y + b * rate, self.v - w * (c * y + d * rate))


def slips(course: Course, steps: Mask, direction: Series) -> Slips:
    """Return the equations of slip of the chosen steps, in the direction that each has."""
    s = {name: np.asarray(values[steps], np.longdouble) for name, values in course.settings.items()}
    friction = direction[steps] * s["mu_k"] * course.normal_force[steps]
    return Slips(s["m"], s["k"], s["c"], s["v"], s["F_ext"] - friction)


def state(course: Course, steps: Mask) -> State:
    """Return the state that the side had at the beginning of the chosen steps."""
    z, x_dot = (course.before(name)[steps] for name in ("z", "x_dot"))
    return State(np.asarray(z, np.longdouble), np.asarray(x_dot, np.longdouble))


def _transition(tau: Wide, two_zeta: Wide) -> tuple[Wide, Wide, Wide, Wide]:
    """Return the entries of exp([[0, 1], [-1, -2 zeta]] tau), row by row."""
    if tau.size == 0:
        return tau, tau, tau, tau
    norm = np.max(np.abs(tau) * np.maximum(1.0 + two_zeta, 1.0))
    halvings = max(0, int(np.ceil(np.log2(float(norm) / _LARGEST)))) if norm > 0.0 else 0
    short = tau / np.longdouble(2.0) ** halvings
    step = np.stack([np.stack([0 * short, short]), np.stack([-short, -two_zeta * short])])
    eye = np.zeros_like(step)
    eye[0, 0] = eye[1, 1] = 1.0
    total, term = eye.copy(), eye
    for n in range(1, _TERMS):
        term = np.einsum(_PRODUCT, term, step) / n
        total = total + term
    for _ in range(halvings):
        total = np.einsum(_PRODUCT, total, total)
    return total[0, 0], total[0, 1], total[1, 0], total[1, 1]
