"""Quantities that people type for the command; plain numbers are SI."""

from stickslip.errors import CommandError
from stickslip_design.quantity import KINDS as KINDS
from stickslip_design.quantity import QuantityError, typed


def parse(text: str, unit: str, option: str, within: str = "") -> float:
    """Read a quantity that a person typed, `stickslip_design.quantity.typed`.

    Parameters
    ----------
    text, unit, within
        As of `typed`.
    option
        The name under which the person gave it, for the message.

    Raises
    ------
    CommandError
        If the text is no such quantity; the message names the option, the text and what is
        expected.
    """
    try:
        return typed(text, unit, within)
    except QuantityError as error:
        raise CommandError(f"{option} {text!r} {error}") from None
