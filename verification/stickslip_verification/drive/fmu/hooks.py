"""Planted faults that act on the calls between the suite, as master, and an FMU."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from stickslip_verification.drive.fmu.instance import FmuInstance, Unpacked

if TYPE_CHECKING:
    from stickslip_verification.suite.faults import Hook


class Hooked(FmuInstance):
    """An instance whose reads pass `get`; a hook may keep attributes of its own on it."""

    def __init__(self, fmu: Unpacked) -> None:
        self._readers: dict[tuple[str, ...], Callable[[], list[float]]] = {}
        super().__init__(fmu)

    def read(self, names: Sequence[str]) -> dict[str, float]:
        """Read variables from the FMU itself, past the planted `get`."""
        key = tuple(names)
        if key not in self._readers:
            self._readers[key] = super().reader(key)
        return dict(zip(key, self._readers[key](), strict=True))

    def get(self, names: Sequence[str]) -> dict[str, float]:
        """Read variables as the suite sees them."""
        return self.read(names)

    def reader(self, names: Sequence[str]) -> Callable[[], list[float]]:
        """Return a function that reads these variables at once, in this order, in SI."""
        # It refuses a name that the FMU does not have.
        super().reader(names)

        def read() -> list[float]:
            values = self.get(names)
            return [values[name] for name in names]

        return read


def hooked(face: type[FmuInstance], hooks: Sequence[Hook]) -> type[FmuInstance]:
    """Return the class of the instances that these hooks act on, one laid over the other."""
    if not hooks:
        return face
    made = type("Hooked", (Hooked, face), {})
    for name, code in hooks:
        space: dict[str, Any] = {"original": getattr(made, name)}
        exec(code, space)
        setattr(made, name, space[name])
    return made
