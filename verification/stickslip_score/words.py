"""Figures in words: units in which a value is neither tiny nor huge."""

import math


def percent(ratio: float) -> str:
    """Return by how much a ratio is off 1."""
    if not math.isfinite(ratio):
        return "where there should be none"
    return f"{abs(100.0 * (ratio - 1.0)):.3g} % {'larger' if ratio > 1.0 else 'smaller'}"


def _scaled(value: float, units: tuple[tuple[float, str], ...]) -> str:
    if value == 0.0:
        return f"0 {next(unit for size, unit in units if size == 1.0)}"
    size, unit = next((u for u in units if abs(value) >= u[0]), units[-1])
    return f"{value / size:.3g} {unit}"


def length(value: float) -> str:
    """Return a length [m] in a unit that fits."""
    return _scaled(value, ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")))


def time(value: float) -> str:
    """Return a time [s] in a unit that fits."""
    return _scaled(value, ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns")))


def speed(value: float) -> str:
    """Return a velocity [m/s] in a unit that fits."""
    return _scaled(value, ((1.0, "m/s"), (1e-3, "mm/s"), (1e-6, "µm/s"), (1e-9, "nm/s")))


def force(value: float) -> str:
    """Return a force [N] in a unit that fits."""
    return _scaled(value, ((1e3, "kN"), (1.0, "N"), (1e-3, "mN")))


def signed_time(value: float) -> str:
    """Return a difference of times [s] with its sign."""
    return f"{'+' if value >= 0 else '−'}{time(abs(value))}"


def signed_length(value: float) -> str:
    """Return a difference of lengths [m] with its sign."""
    return f"{'+' if value >= 0 else '−'}{length(abs(value))}"
