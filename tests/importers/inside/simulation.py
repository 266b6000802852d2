"""What is asked of every importer: runs of cases, and probes of what it can do."""

import itertools
import re
from collections.abc import Iterator
from functools import partial
from typing import Any, Self

import fmpy

from tests.importers.cases import STEP

ALONE = ("block",)
PAIR = ("a", "b")
LINK = (("a", "F"), ("b", "F_ext"))
"""Of two blocks the spring force of the first pushes the second."""
PROBES: dict[str, Any] = {
    "state": "save|restore|state",
    "serialize": "serial|export",
    "units": "unit",
    **dict.fromkeys(("inputs", "parameters", "several", "resets", "any_step")),
}
"""Names of probes, and what one looks for among the calls of an importer that has no such probe."""


class NotOfferedError(Exception):
    """The importer has no way to do this."""


class Simulation:
    """Blocks in an importer, from the start on; each importer has a subclass."""

    time: float
    """Where the simulation stands [s]."""
    shows_start = True
    """Whether outputs can be read before the first step."""
    offering: tuple[type, ...] = ()
    """Classes of the importer, among whose methods one looks for what they offer."""
    errors: tuple[type[Exception], ...] = (NotOfferedError,)
    """What the importer raises where it cannot do something, or the FMU refuses it."""

    def __init__(
        self, fmu: str, start: Any = None, blocks: tuple[str, ...] = ALONE, messages: bool = False
    ) -> None:
        self.fmu, self.start, self.blocks = fmu, start or {}, blocks
        # The importer is asked to show the messages of the FMU, and to write a table.
        self.messages = messages
        self.open()

    def open(self) -> None:
        """Initialize the blocks with these names, those of `PAIR` connected by `LINK`."""

    def step(self, h: float | None = None) -> None:
        """Make a communication step, of another length [s] where one is given."""

    def set(self, name: str, value: Any, block: str = ALONE[0]) -> None:
        """Set a variable before the next step."""

    def get(self, name: str, block: str = ALONE[0]) -> Any:
        """Return a variable at the end of the last step."""

    def reset(self) -> None:
        raise NotOfferedError("reset")

    def close(self) -> None:
        """End the simulation in order."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def of_each(self, values: Any) -> Iterator[tuple[str, str, Any]]:
        for block in self.blocks:
            for name, value in values.items():
                if (block, name) != LINK[1]:
                    yield block, name, value

    @classmethod
    def run(cls, fmu: str, case: Any, blocks: tuple[str, ...] = ALONE) -> Any:
        """Run a case; `restart` twice, by a reset or, where there is none, by a new simulation."""
        with cls(fmu, case["start"], blocks) as simulation:
            rows = simulation.play(case)
            if case["name"] == "restart":
                try:
                    simulation.reset()
                    rows["again"] = simulation.play(case)
                except NotOfferedError:
                    simulation.close()
                    rows["again"] = cls.run(fmu, {**case, "name": "second"}, blocks)
        return rows

    @classmethod
    def pair(cls, fmu: str, case: Any) -> Any:
        return cls.run(fmu, case, PAIR)

    def play(self, case: Any) -> dict[str, Any]:
        names = outputs(self.fmu)
        rows: dict[str, Any] = {b: {name: [] for name in names} for b in self.blocks}
        times: list[float] = []
        for number in range(-1 if self.shows_start else 0, case["steps"]):
            if number >= 0:
                for block, name, value in self.of_each(case["changes"].get(str(number), {})):
                    self.set(name, value, block)
                self.step()
            times.append(self.time)
            for block, name in itertools.product(self.blocks, names):
                rows[block][name].append(self.get(name, block))
        first, *second = rows.values()
        return {"times": times, "outputs": first, "nested": second}

    @classmethod
    def tried(cls, fmu: str) -> dict[str, bool]:
        probes: dict[str, Any] = {
            name: partial(getattr(cls, name), fmu) if hasattr(cls, name) else partial(cls.offers, s)
            for name, s in PROBES.items()
        }
        found = {}
        for name, probe in probes.items():
            try:
                found[name] = bool(probe())
            except cls.errors:
                found[name] = False
        return found

    @classmethod
    def inputs(cls, fmu: str) -> bool:
        with cls(fmu) as simulation:
            simulation.step()
            simulation.set("v", 0.05)
            simulation.step()
            return bool(abs(simulation.get("x_pull") - STEP * 0.07) < 1e-15)

    @classmethod
    def parameters(cls, fmu: str) -> bool:
        with cls(fmu) as simulation:
            simulation.step()
            simulation.set("k", 2000.0)
            simulation.step()
            return bool(simulation.get("F") == 2000.0 * simulation.get("z"))

    @classmethod
    def several(cls, fmu: str) -> bool:
        with cls(fmu, blocks=("one", "other")) as simulation:
            simulation.set("v", 0.05, "other")
            simulation.step()
            ways = [simulation.get("x_pull", block) for block in ("one", "other")]
            return bool(abs(ways[0] - 2e-4) < 1e-15 and abs(ways[1] - 5e-4) < 1e-15)

    @classmethod
    def resets(cls, fmu: str) -> bool:
        with cls(fmu) as simulation:
            first = simulation.go()
            simulation.set("v", 0.05)
            simulation.step()
            simulation.reset()
            return bool(simulation.go() == first)

    @classmethod
    def any_step(cls, fmu: str) -> bool:
        with cls(fmu) as simulation:
            simulation.step(STEP)
            simulation.step(0.037)
            return bool(abs(simulation.get("x_pull") - 0.02 * 0.047) < 1e-15)

    @classmethod
    def offers(cls, words: str) -> bool:
        names = {name for each in cls.offering for name in dir(each) if not name.startswith("_")}
        return any(re.search(words, name) for name in names)

    @classmethod
    def warn(cls, fmu: str) -> None:
        with cls(fmu, {"mu_k": 0.9}, messages=True) as simulation:
            simulation.step()

    @classmethod
    def refused(cls, fmu: str, when: str) -> str:
        try:
            with cls(fmu, {"k": -1.0} if when == "at the start" else {}) as simulation:
                if when != "at the start":
                    simulation.step()
                    simulation.set("k", -1.0)
                before = simulation.time
                simulation.step()
                assert simulation.time > before
                # At rest most outputs are 0, but never these two.
                shown = {simulation.get(name) for name in ("m", "F_s")}
        except cls.errors as error:
            return str(error)
        return "goes on: every output is 0" if shown == {0.0} else f"goes on with {shown}"

    def go(self) -> list[float]:
        ways = []
        for _ in range(30):
            self.step()
            ways.append(float(self.get("x")))
        return ways


def outputs(fmu: str) -> list[str]:
    variables = fmpy.read_model_description(fmu).modelVariables
    return [each.name for each in variables if each.causality == "output"]
