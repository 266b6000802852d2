"""How a result shows itself, whatever it is of."""

from __future__ import annotations

import io
import json
import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType

_WIDTH = 110
"""Characters in a line of a notebook."""


class Shown(ABC):
    """A result that shows itself: in a terminal by its repr, in a notebook as a table."""

    @abstractmethod
    def table(self) -> RenderableType:
        """Return the table that the command prints, for rich."""

    @abstractmethod
    def plot(self) -> Figure | None:
        """Draw it; None where there is nothing to draw."""

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """Return the figures in SI, as JSON knows them."""

    def to_json(self) -> str:
        """Return the figures in SI as JSON; what is not finite is null."""
        return json.dumps(_plain(self.to_dict()), indent=2, ensure_ascii=False, allow_nan=False)

    def _repr_html_(self) -> str:
        from rich.console import Console

        console = Console(
            record=True, width=_WIDTH, file=io.StringIO(), markup=False, force_jupyter=False
        )
        console.print(self.table())
        return console.export_html(inline_styles=True, code_format="<pre>{code}</pre>")


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(name): _plain(each) for name, each in value.items()}
    if hasattr(value, "_asdict"):
        return _plain(value._asdict())
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
