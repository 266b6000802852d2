"""A pendulum that warns with a percent sign."""

from tests.fmukit.pendulum import SPEC as PENDULUM
from tests.fmukit.pendulum import Pendulum

TOLD = "swings are 20 % slower than rated, 100 %s of them"


class Grumbling(Pendulum):
    """The pendulum with a warning."""

    def warning(self) -> str | None:
        """Return a text that a format would misread."""
        return TOLD


SPEC = PENDULUM._replace(model=Grumbling)
