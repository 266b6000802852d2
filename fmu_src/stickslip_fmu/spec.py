"""Specifications of the FMU: the block under a friction law, with name, release and experiment."""

from fmi.model import Experiment, Spec

from .block import Block
from .interface import CONTRACT, table_of
from .laws.coulomb.law import COULOMB
from .laws.law import Law
from .laws.native_only import NativeOnly
from .release import DATE, VERSION
from .settings import Settings


def spec_of(friction_law: Law) -> Spec:
    """Return the specification of the block under a friction law."""
    own = friction_law.interface

    class LawSettings(Settings, table=table_of(own)):
        """Parameters, inputs and start values, those of the friction law among them."""

    class LawBlock(Block):
        """The block under the friction law."""

        law = friction_law

    return Spec(
        name=own.model,
        description=own.description,
        author="The stickslip engineers",
        version=VERSION,
        date=DATE,
        licence="MIT",
        values=LawSettings,
        model=LawBlock,
        experiment=Experiment(0.0, 10.0, 0.01),
        annotations=() if isinstance(friction_law, NativeOnly) else (CONTRACT,),
    )


SPEC = spec_of(COULOMB)
TABLE = SPEC.table
