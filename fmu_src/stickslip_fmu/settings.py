"""The values that rule the motion: parameters and inputs together."""

from typing import Dict, Mapping


class BlockError(ValueError):
    """Values or a step that the block cannot follow; the text says which, and the range."""


class Settings:
    """Parameters, inputs and start values [SI units]: docs/theory.md (1).

    Once made they stay as they are, so blocks and states may share them: see `changed`.

    Parameters
    ----------
    values
        Every name of `__slots__` with its value: mass m, gravity g, stiffness k, damping c,
        friction coefficients mu_s and mu_k; pulling velocity v, normal force `load` on top of
        m g, external force F_ext on the mass; initial position x_start, velocity x_dot_start
        and spring extension z_start.
    """

    __slots__ = (
        "F_ext",
        "c",
        "g",
        "k",
        "load",
        "m",
        "mu_k",
        "mu_s",
        "v",
        "x_dot_start",
        "x_start",
        "z_start",
    )

    m: float
    g: float
    k: float
    c: float
    mu_s: float
    mu_k: float
    v: float
    load: float
    F_ext: float
    x_start: float
    x_dot_start: float
    z_start: float

    def __init__(self, values: Mapping[str, float]) -> None:
        for name in self.__slots__:
            setattr(self, name, values[name])

    def as_dict(self) -> Dict[str, float]:
        """Return the values by name."""
        return {name: getattr(self, name) for name in self.__slots__}

    def changed(self, name: str, value: float) -> "Settings":
        """Return these values, but for one."""
        # Written out, for it is done whenever an input changes.
        twin = Settings.__new__(Settings)
        twin.F_ext = self.F_ext
        twin.c = self.c
        twin.g = self.g
        twin.k = self.k
        twin.load = self.load
        twin.m = self.m
        twin.mu_k = self.mu_k
        twin.mu_s = self.mu_s
        twin.v = self.v
        twin.x_dot_start = self.x_dot_start
        twin.x_start = self.x_start
        twin.z_start = self.z_start
        setattr(twin, name, value)
        return twin

    def normal_force(self) -> float:
        """Return m g + load [N]; raises BlockError where the load would lift the mass."""
        weight = self.m * self.g
        if not self.load >= -weight:
            raise BlockError(
                f"load = {self.load!r} N is out of range: it must be at least "
                f"-m g = {-weight!r} N, or the mass lifts off"
            )
        return weight + self.load
