"""Blocks nested in a container FMU, which FMPy runs."""

from functools import cache
from typing import Any

from .by_fmpy import Fmpy
from .simulation import PAIR


class Container(Fmpy):
    """A container with a pair, or for each block a container of its own."""

    threads = False
    """Whether each block is stepped in a thread of its own."""

    @staticmethod
    def nest(fmu: str, blocks: tuple[str, ...], threads: bool) -> str:
        """Make a container and return its path; its variables are called as `a.F`."""
        raise NotImplementedError

    def made(self) -> str:
        inside = PAIR if self.blocks == PAIR else PAIR[:1]
        return _nested(self.nest, self.fmu, inside, self.threads)

    def of_blocks(self, instantiate: Any) -> dict[str, Any]:
        if self.blocks == PAIR:
            return dict.fromkeys(PAIR, instantiate())
        return super().of_blocks(instantiate)

    def named(self, name: str, block: str) -> Any:
        return self.variables[f"{block if self.blocks == PAIR else PAIR[0]}.{name}"]


@cache
def _nested(nest: Any, *arguments: Any) -> str:
    return str(nest(*arguments))
