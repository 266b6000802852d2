"""The block's `lifetime`, which takes the place of this file when the FMU is packed."""

from stickslip_fmu.lifetime import give_reference, hold

__all__ = ["give_reference", "hold"]
