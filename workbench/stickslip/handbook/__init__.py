"""What travels in the FMU for people: its documentation, the page, its icon, the licences."""

from stickslip.handbook.parts import parts

__all__ = ["parts"]
