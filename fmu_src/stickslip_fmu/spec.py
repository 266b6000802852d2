"""What the kit makes the FMU of: the block with its name, release and default experiment."""

from fmukit.model import Experiment, Spec

from .model import Block
from .release import DATE, VERSION
from .settings import Settings

SPEC = Spec(
    name="StickSlip",
    description=(
        "A mass pulled over dry friction through a spring: sticks, breaks away, slips, sticks "
        "again. Solved exactly from event to event, so no result depends on the communication step."
    ),
    author="The stickslip engineers",
    version=VERSION,
    date=DATE,
    licence="MIT",
    values=Settings,
    model=Block,
    experiment=Experiment(0.0, 10.0, 0.01),
)
