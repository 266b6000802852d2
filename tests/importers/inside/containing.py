"""Blocks nested in a container FMU, which FMPy runs."""

from functools import cache
from typing import Any

from .by_fmpy import Fmpy, simulated
from .simulation import ALONE, LINK, PAIR, STEP, outputs


class Container(Fmpy):
    """Containers with one block each, for the probes; runs are of one container with a pair."""

    @classmethod
    def nest(
        cls, fmu: str, step: float, blocks: tuple[str, ...] = PAIR, *, threads: bool = False
    ) -> str:
        """Make a container and return its path; its variables are called as `a.F`."""
        raise NotImplementedError

    @classmethod
    @cache
    def made(cls, fmu: str) -> str:
        return cls.nest(fmu, STEP, PAIR[:1])

    @classmethod
    def run(
        cls, fmu: str, case: Any, blocks: tuple[str, ...] = ALONE, *, threads: bool = False
    ) -> Any:
        assert blocks == ALONE
        names = outputs(fmu)
        both = {
            **case,
            "start": _for_both(case["start"]),
            "changes": {number: _for_both(each) for number, each in case["changes"].items()},
        }
        container = cls.nest(fmu, case["step"], threads=threads)
        rows = simulated(container, both, [f"{block}.{name}" for block in PAIR for name in names])
        again = _split(rows["again"], names) if "again" in rows else None
        return {**_split(rows, names), "again": again}


def _for_both(values: Any) -> dict[str, float]:
    pairs = [(block, name) for block in PAIR for name in values]
    return {f"{block}.{name}": values[name] for block, name in pairs if (block, name) != LINK[1]}


def _split(rows: Any, names: list[str]) -> dict[str, Any]:
    first, second = (
        {
            "times": rows["times"],
            "outputs": {name: rows["outputs"][f"{block}.{name}"] for name in names},
        }
        for block in PAIR
    )
    return {**first, "nested": second}
