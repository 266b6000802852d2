"""Series of machines whose probability of jumping is known in closed form."""

import math

from scipy.special import ndtr

from stickslip_design.axis import AxisFile, axis_file_of
from stickslip_ref import Parameters, critical_lambda

MASS, STIFFNESS, ZETA, MU_K = 500.0, 4e7, 0.05, 0.15


def series(**changed: str) -> AxisFile:
    values = {"mass": f'"{MASS} kg"', "stiffness": f'"{STIFFNESS} N/m"', "zeta": str(ZETA),
              "load": '"0 N"', "mu_s": "0.20", "mu_k": str(MU_K)} | changed  # fmt: skip
    lines = [f"{name} = {value}" for name, value in values.items()]
    text = ["[axis]", *lines[:4], "[friction]", *lines[4:], "[demand]", 'feeds = ["1 mm/s"]']
    return axis_file_of("\n".join(text))


def gap(feed: float) -> float:
    """Return the gap from which on the axis jumps at a feed: v_c = w Delta / lambda_c."""
    N = float(Parameters(m=MASS, k=STIFFNESS).N)
    return feed * float(critical_lambda(ZETA)) * math.sqrt(STIFFNESS * MASS) / N


def share_that_jumps(
    feed: float, mu_s: tuple[float, float], mu_k: tuple[float, float] = (MU_K, 0.0),
    correlation: float = 0.0,
) -> float:  # fmt: skip
    """Return the probability of jumping, of normal coefficients by mean and deviation."""
    variance = mu_s[1] ** 2 + mu_k[1] ** 2 - 2.0 * correlation * mu_s[1] * mu_k[1]
    return float(ndtr((mu_s[0] - mu_k[0] - gap(feed)) / math.sqrt(variance)))
