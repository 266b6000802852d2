"""What Ecos can do where the FMU runs in a process of its own."""

from . import able_ecospy
from .by_proxyfmu import prepare, uri


class Probes(able_ecospy.Probes):
    """The same, through proxyfmu."""

    def __init__(self) -> None:
        prepare()

    def at(self, fmu: str) -> str:
        """Return what makes Ecos start proxyfmu for the FMU."""
        return uri(fmu)


PROBES = Probes()
