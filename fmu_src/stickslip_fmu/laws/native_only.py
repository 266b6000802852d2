"""Friction laws that the native FMU alone has: their rows, and no motion."""

from typing import NamedTuple, NoReturn, Optional

from fmi.model import ModelError
from fmi.table import Variable

from ..interface import Own, parameter
from ..settings import Settings
from .law import Friction


class NativeOnly(NamedTuple):
    """A friction law whose motion is in C alone: `law.Law` without its answers."""

    interface: Own

    def warning(self, settings: Settings) -> Optional[str]:
        """Return None: the native FMU warns."""
        return None

    def under(self, settings: Settings, before: Optional[Friction] = None) -> NoReturn:
        """Raise ModelError that says which FMU has the law."""
        raise ModelError(refusal(self))


def refusal(law: NativeOnly) -> str:
    """Return why there is no Python FMU of the law."""
    return (
        f"{law.interface.model} has no Python FMU: its motion is integrated in C; "
        "build the native FMU (--native)"
    )


def v_stick(number: int) -> Variable:
    """Return the row of the speed below which a law without a stick shows one."""
    text = "Speed below which sticking and mode show a stick; nothing else depends on it"
    return parameter(number, "v_stick", "Velocity", "fixed", 1e-4, text, 0.0)
