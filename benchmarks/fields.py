"""Whole fields of parameters for the closed forms, and the memory that these take for one."""

import tracemalloc
from collections.abc import Callable

import numpy as np

from stickslip_ref import Cycle, FloatOrArray, Parameters, coulomb_limit, steady_cycle


def undamped(count: int) -> Parameters:
    """Return machines of all sizes without damping."""
    random = np.random.default_rng(2)
    k = 10.0 ** random.uniform(1.0, 8.0, count)
    m = 10.0 ** random.uniform(-2.0, 4.0, count)
    v = 10.0 ** random.uniform(-6.0, 1.0, count)
    mu_s = 10.0 ** random.uniform(-2.0, 0.17, count)
    mu_k = mu_s * (1.0 - 10.0 ** random.uniform(-3.0, 0.0, count))
    return Parameters(m=m, k=k, v=v, mu_s=mu_s, mu_k=mu_k)


def damped(count: int) -> Parameters:
    """Return damped machines, each pulled below its critical velocity: all have a cycle."""
    p, random = undamped(count), np.random.default_rng(3)
    c = 2.0 * 10.0 ** random.uniform(-4.0, -0.1, count) * np.sqrt(p.k * p.m)
    still = Parameters(m=p.m, k=p.k, c=c, mu_s=p.mu_s, mu_k=p.mu_k)
    v = coulomb_limit(still) * 10.0 ** random.uniform(-6.0, -1e-3, count)
    return Parameters(m=p.m, k=p.k, c=c, mu_s=p.mu_s, mu_k=p.mu_k, v=v)


def evaluated(p: Parameters) -> tuple[Cycle, FloatOrArray]:
    """Return cycle and critical velocity, from the numbers on: the parameters are checked anew."""
    p = Parameters(m=p.m, k=p.k, c=p.c, mu_s=p.mu_s, mu_k=p.mu_k, v=p.v)
    return steady_cycle(p), coulomb_limit(p)


def memory_beyond(side: Callable[[], object]) -> int:
    """Return the most memory [B] in use at once, besides what is there before and its result."""
    tracemalloc.start()
    try:
        result = side()
        kept, peak = tracemalloc.get_traced_memory()
        del result
    finally:
        tracemalloc.stop()
    return peak - kept
