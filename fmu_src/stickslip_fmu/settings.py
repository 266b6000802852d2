"""The values that rule the motion: parameters, inputs and start values together."""

from fmi.model import ModelError
from fmi.table import Values


class Settings(Values):
    """Parameters, inputs and start values of the block [SI units]: docs/theory.md (1).

    A subclass names the table; that of a friction law has the law's parameters too.
    """

    def normal_force(self) -> float:
        """Return m g + load [N]; raises ModelError where the load would lift the mass."""
        weight = self.m * self.g
        if not self.load >= -weight:
            raise ModelError(
                f"load = {self.load!r} N is out of range: it must be at least "
                f"-m g = {-weight!r} N, or the mass lifts off"
            )
        return weight + self.load
