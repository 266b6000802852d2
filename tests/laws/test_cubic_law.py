"""The cubic law of Thomsen and Fidlin: averaged formulas against the exact limits.

J. J. Thomsen and A. Fidlin, Analytical approximations for stick-slip vibration amplitudes, Int. J.
Non-Linear Mech. 38 (2003) 389-403: mu(u) = mu_s - 3/2 d (q - q^3/3), q = u/v_m, d = mu_s - mu_m.

With the deviation y = u - v of the speed the slip obeys, divided by m, with times in units of 1/w,

    y'' + y + e (2 b - 3/2 + 3/2 (q + y)^2 + ...) y' = 0,   e = N d/(m w v_m),  b = c v_m/(2 N d),

speeds over v_m, so by averaging the amplitude A of y follows A' = -e/2 A (2 b - 3/2 (1 - q^2) +
3/8 A^2). It is at rest for A = 0, unstable where q^2 < q_1^2 = 1 - 4 b/3, and for A^2 = 4 (q_1^2 -
q^2). The swing touches standstill where A = q, that is at q^2 = 4/5 q_1^2.
"""

import math

import pytest

from stickslip_ref import Coulomb, Parameters, critical_velocity

MU_S, MU_M, V_M = 0.4, 0.25, 0.5
"""Coefficients at rest and at the least, and the speed of the least [m/s]."""


class Cubic(Coulomb):
    constant_in_slip = False

    def slip_friction(self, p: Parameters, speed: float, state: object = ()) -> float:
        q = speed / V_M
        return float(p.N * (MU_S - 1.5 * (MU_S - MU_M) * (q - q * q * q / 3.0)))

    def speeds(self, p: Parameters) -> tuple[float, ...]:
        return (V_M,)


def block(e: float, b: float) -> Parameters:
    m, g = 1.0, 9.81
    w = m * g * (MU_S - MU_M) / (m * V_M * e)
    c = 2.0 * b * m * g * (MU_S - MU_M) / V_M
    return Parameters(m=m, g=g, k=m * w * w, c=c, mu_s=MU_S, mu_k=MU_M)


@pytest.mark.parametrize("b", [0.0, 0.2, 0.5])
def test_averaged_limits_are_met_with_the_square_of_the_friction(b: float) -> None:
    q_1 = math.sqrt(1.0 - 4.0 * b / 3.0)
    errors = []
    for e in (0.4, 0.2, 0.1):
        found = critical_velocity(block(e, b), Cubic(), between=(0.01 * V_M, 3.0 * V_M))
        (unstable,), (cycle,) = found.unstable, found.cycle
        assert unstable.high == pytest.approx(q_1 * V_M, rel=1e-8)
        assert (unstable.high_end, cycle.high_end) == ("eigenvalue", "grazing")
        errors.append(cycle.high / (math.sqrt(0.8) * q_1 * V_M) - 1.0)
        assert found.motions(0.5 * (cycle.high + unstable.high)) == ("swings",)
    assert abs(errors[-1]) < 0.01
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.25)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.1)
