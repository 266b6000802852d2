"""The block of Coulomb's friction law, which the FMU is made of."""

from . import block
from .laws.coulomb.law import COULOMB


class Block(block.Block):
    """The stick-slip block with Coulomb friction."""

    law = COULOMB
