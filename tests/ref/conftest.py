"""Random points of the block, drawn from fixed seeds."""

import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from stickslip_ref import Parameters, critical_lambda

Draw = Callable[..., Iterator[Parameters]]


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(10.0 ** rng.uniform(math.log10(low), math.log10(high)))


def _friction(rng: np.random.Generator) -> dict[str, float]:
    mu_s = _log_uniform(rng, 0.01, 1.5)
    mu_k = mu_s * (1.0 - _log_uniform(rng, 1e-3, 1.0))
    k, m = _log_uniform(rng, 10.0, 1e8), _log_uniform(rng, 1e-2, 1e4)
    return {"k": k, "m": m, "mu_s": mu_s, "mu_k": mu_k}


@pytest.fixture
def undamped_points() -> Draw:
    """Machines of all sizes without damping; lambda from a range if one is given."""

    def draw(
        count: int, seed: int, lambda_range: tuple[float, float] | None = None
    ) -> Iterator[Parameters]:
        rng = np.random.default_rng(seed)
        while count:
            values = _friction(rng)
            v = _log_uniform(rng, 1e-6, 10.0)
            if lambda_range:
                v = float(Parameters(**values, v=1.0).lambda_) / _log_uniform(rng, *lambda_range)
            p = Parameters(**values, v=v)
            if lambda_range or p.lambda_ >= 1e-3:
                count -= 1
                yield p

    return draw


@pytest.fixture
def damped_points() -> Callable[[int, int], Iterator[tuple[Parameters, float]]]:
    """Damped machines about lambda_c, with d = lambda / lambda_c - 1; -1 if zeta >= 1."""

    def draw(count: int, seed: int) -> Iterator[tuple[Parameters, float]]:
        rng = np.random.default_rng(seed)
        while count:
            values = _friction(rng)
            zeta = _log_uniform(rng, 1e-4, 3.0)
            d = _log_uniform(rng, 2e-9, 10.0) * float(rng.choice([-1.0, 1.0]))
            edge = float(critical_lambda(zeta))
            if d <= -1.0 or not edge < 1e9:
                if zeta < 1.0:
                    continue
                edge, d = _log_uniform(rng, 1e-2, 1e5), -1.0
            still = Parameters(**values, v=1.0)
            lambda_ = edge * (1.0 + d) if zeta < 1.0 else edge
            v = float(still.lambda_) / lambda_
            c = 2.0 * values["m"] * float(still.w) * zeta
            count -= 1
            yield Parameters(**values, v=v, c=c), d

    return draw
