"""Random sequences of calls, as a careless master might make them.

A call is a list: the name of what `inside.player.Player` does, and its arguments. A sequence
lives a plausible life, so that calls meet every phase, and strays from it at any moment.
"""

import math
import random
from collections.abc import Callable, Sequence
from typing import Any

from tests.fmu.fuzz.variables import VARIABLES, Variables

Call = list[Any]

_NOT_FINITE = (math.nan, math.inf, -math.inf)
# Of k and m the extremes keep the slips far longer or far shorter than any step: in between a
# step may rightly hold millions of transitions.
_EXTREME = (1e300, 1.7e308, 1e-300, 2.3e-308, 5e-324, -0.0, -1e-300, -1.0, -1e300)
_STEPS = (1e-300, 5e-324, 1e-13, 1.7e-13, 1e-9, 3e-6)
_BAD_STEPS = (0.0, -0.0, -1e-300, -0.01, *_NOT_FINITE)
_HUGE_STEPS = (1e17, 1e300)
_INSTANCE_NAMES = (
    "a",
    "%",
    "%s%n",
    "%d%%",
    "Ruckgleiten \u00e9\u00df",
    "\u6469\u64e6 \U0001f9f1",
    "",
    "x" * 300,
)
_KINDS = ("Real", "Integer", "Boolean", "String")
_TEXTS = ("", "x", "%n%s", "\u00e4")


def sequence(seed: int, law: str = "coulomb") -> list[Call]:
    """Return the calls of a seed, 5 to 60 and what is instantiated meanwhile."""
    return _Master(random.Random(seed), VARIABLES[law]).calls()


class _Master:
    """One careless master; `alive` holds what it believes of each instance."""

    def __init__(self, generator: random.Random, variables: Variables) -> None:
        self.generator = generator
        self.variables = variables
        self.alive: dict[int, str] = {}
        self.time: dict[int, float] = {}
        self.broken: set[int] = set()
        self.filled: set[int] = set()
        self.packed: set[int] = set()
        self.freed: set[int] = set()
        self.failed_to_get: set[int] = set()
        # Careful masters meet the deep states, careless ones the refusals.
        self.carelessness = generator.choice([0.0, 0.01, 0.05, 0.3])
        self.instances = generator.choice([1, 1, 1, 2, 3])

    def calls(self) -> list[Call]:
        made: list[Call] = []
        length = self.generator.randint(5, 60)
        while len(made) < length:
            i = self.generator.randrange(self.instances)
            if i not in self.alive:
                made.append(self._instantiate(i))
            made.append(self._call(i))
        return made

    def _careless(self) -> bool:
        return self.generator.random() < self.carelessness

    def _instantiate(self, i: int) -> Call:
        self.alive[i] = "instantiated"
        self.time[i] = 0.0
        self.broken.discard(i)
        name = self.generator.choice(_INSTANCE_NAMES)
        return ["instantiate", i, name, self.generator.random() < 0.3]

    def _call(self, i: int) -> Call:
        if i in self.broken and self.generator.random() < 0.25:
            return self.generator.choice([self._reset, self._free])(i)
        if self._careless():
            return self.generator.choice(_EVERY)(self, i)
        ways, weights = _USUAL[self.alive[i]]
        return self.generator.choices(ways, weights)[0](self, i)

    def _set_up(self, i: int) -> Call:
        generator = self.generator
        start = generator.choice([0.0, 0.0, 5.0, -3.0, 1e9])
        if self._careless():
            start = self._break(i, generator.choice(_NOT_FINITE))
        self.time[i] = start
        stop = generator.choice([None, None, start + 10.0, start - 1.0, math.nan])
        return ["set_up", i, start, stop, generator.choice([None, 1e-6, -1.0, math.nan])]

    def _enter(self, i: int) -> Call:
        self._move(i, "instantiated", "initialization")
        return ["enter", i]

    def _exit(self, i: int) -> Call:
        self._move(i, "initialization", "stepping")
        return ["exit", i]

    def _terminate(self, i: int) -> Call:
        self.alive[i] = "terminated"
        return ["terminate", i]

    def _reset(self, i: int) -> Call:
        self.alive[i] = "instantiated"
        self.broken.discard(i)
        return ["reset", i]

    def _free(self, i: int) -> Call:
        del self.alive[i]
        return ["free", i]

    def _step(self, i: int) -> Call:
        generator = self.generator
        step = generator.choice([10.0 ** generator.uniform(-4.0, -0.5)] * 5 + [2.0])
        if generator.random() < 0.1:
            step = generator.choice(_STEPS)
        elif self._careless():
            step = self._break(i, generator.choice(_BAD_STEPS))
        elif generator.random() < 0.006:
            step = self._break(i, generator.choice(_HUGE_STEPS))
        time = self.time[i]
        if self._careless():
            time = generator.choice([0.0, -1.0, 1e300, *_NOT_FINITE])
        elif math.isfinite(step):
            self.time[i] += step
        if self.alive[i] != "stepping":
            self.broken.add(i)
        return ["step", i, time, step, generator.random() < 0.5]

    def _get(self, i: int) -> Call:
        generator = self.generator
        kind = generator.choices(_KINDS, [6, 2, 2, 0.3])[0]
        references = list(self.variables.references[kind])
        if references and generator.random() < 0.7:
            references = [generator.choice(references) for _ in range(generator.randint(0, 5))]
        return ["get", i, kind, self._misled(i, references)]

    def _set(self, i: int) -> Call:
        generator = self.generator
        early = self.alive[i] in ("instantiated", "initialization")
        if early and self.variables.whole and generator.random() < 0.5:
            return self._set_whole(i) if generator.random() < 0.7 else self._set_points(i)
        count = generator.choice([0, 1, 2, 4, 8] if early else [0, 1, 1, 1, 2, 3])
        variables = self.variables
        references = generator.choices(variables.settable if early else variables.running, k=count)
        references = self._misled(i, references)
        return ["set", i, "Real", references, [self._value(i, each) for each in references]]

    def _set_whole(self, i: int) -> Call:
        generator = self.generator
        references = generator.choices(self.variables.settable_whole, k=generator.choice([1, 2, 3]))
        wanted = [generator.choice(self.variables.whole[self._name(each)]) for each in references]
        if self._careless():
            wanted[0] = int(self._break(i, generator.choice((0, -1, 4, 13, 2**31 - 1))))
        return ["set", i, "Integer", references, wanted]

    def _set_points(self, i: int) -> Call:
        references = self.variables.points
        speeds = [self._value(i, each) for each in references]
        if self.generator.random() < 0.5:
            self.generator.shuffle(speeds)
        return ["set", i, "Real", references, speeds]

    def _set_other(self, i: int) -> Call:
        generator = self.generator
        kind = generator.choice(_KINDS[1:])
        known = self.variables.references[kind]
        references = [generator.choice(known or [0])] if generator.random() < 0.8 else []
        references = self._misled(i, references)
        self.broken.add(i)
        choices: Sequence[Any] = _TEXTS if kind == "String" else (0, 0, 1, -1, 2**31 - 1, -(2**31))
        return ["set", i, kind, references, [generator.choice(choices) for _ in references]]

    def _set_start_values(self, i: int) -> Call:
        rows = self.variables.spec.table.rows
        references = [
            reference
            for reference in self.variables.references["Real"]
            if rows[reference].start is not None
        ]
        return ["set", i, "Real", references, [rows[each].start for each in references]]

    def _get_state(self, i: int) -> Call:
        slot = self.generator.randrange(3)
        if i in self.broken:
            self.failed_to_get.add(i)
        else:
            self.filled.add(slot)
        return ["get_state", i, slot]

    def _set_state(self, i: int) -> Call:
        if self._lacks(self.filled):
            return self._get_state(i)
        self.alive[i] = self.generator.choice(["stepping", self.alive[i]])
        return ["set_state", i, self._slot(self.filled)]

    def _free_state(self, i: int) -> Call:
        slot = self._slot(self.filled)
        self.filled.discard(slot)
        self.freed.add(slot)
        return ["free_state", i, slot]

    def _free_again(self, i: int) -> Call:
        if self._lacks(self.freed):
            return self._free_state(i)
        slot = self._slot(self.freed)
        self.freed.discard(slot)
        return ["free_again", i, slot]

    def _set_freed(self, i: int) -> Call:
        if self.carelessness == 0.0:
            return self._set_state(i)
        if self._lacks(self.freed):
            return self._free_state(i)
        self.broken.add(i)
        return ["set_freed", i, self._slot(self.freed)]

    def _set_null(self, i: int) -> Call:
        if i not in self.failed_to_get and self.generator.random() < 0.95:
            return self._get_state(i)
        self.failed_to_get.discard(i)
        return ["set_null", i]

    def _serialize(self, i: int) -> Call:
        if self._lacks(self.filled):
            return self._get_state(i)
        packed = self.generator.randrange(3)
        self.packed.add(packed)
        return ["serialize", i, self._slot(self.filled), packed]

    def _deserialize(self, i: int) -> Call:
        if self._lacks(self.packed):
            return self._serialize(i)
        damage = self.generator.choice(["cut", "empty", "garbage"]) if self._careless() else ""
        slot = self.generator.randrange(3)
        self.filled.add(slot)
        return ["deserialize", i, self._slot(self.packed), slot, damage]

    def _status(self, i: int) -> Call:
        return ["status", i, self.generator.randrange(5), self.generator.choice([0, 1, 2, 3, 99])]

    def _cancel(self, i: int) -> Call:
        return ["cancel", i]

    def _derivatives(self, i: int) -> Call:
        which = ["directional", "SetRealInputDerivatives", "GetRealOutputDerivatives"]
        return ["derivatives", i, self.generator.choice(which), self.generator.choice([0, 9, 12])]

    def _debug(self, i: int) -> Call:
        categories = self.generator.choice([[], [], ["logAll"], ["logStatusWarning", "none"]])
        return ["debug", i, self.generator.random() < 0.5, categories]

    def _version(self, i: int) -> Call:
        return ["version"]

    def _lacks(self, filled: set[int]) -> bool:
        return not filled and self.generator.random() < 0.95

    def _slot(self, filled: set[int]) -> int:
        """Return one of the three slots, one that holds something if there is."""
        return self.generator.choice(sorted(filled) or range(3))

    def _move(self, i: int, before: str, after: str) -> None:
        if self.alive[i] == before:
            self.alive[i] = after
        else:
            self.broken.add(i)

    def _break(self, i: int, value: float) -> float:
        self.broken.add(i)
        return value

    def _misled(self, i: int, references: list[int]) -> list[int]:
        """Return the references, perhaps with one that is wrong."""
        if not self._careless():
            return references
        self.broken.add(i)
        count = len(self.variables.names)
        wrong = self.generator.choice([count, 2**31, 2**32 - 1, self.generator.randrange(count)])
        where = self.generator.randint(0, len(references))
        return [*references[:where], wrong, *references[where:]]

    def _name(self, reference: int) -> str:
        names = self.variables.names
        return names[reference] if reference < len(names) else ""

    def _value(self, i: int, reference: int) -> float:
        generator = self.generator
        name = self._name(reference)
        if self._careless():
            return self._break(i, generator.choice(_NOT_FINITE))
        if self._careless():
            return self._break(i, generator.choice(_EXTREME))
        if name == "delta" and generator.random() < 0.5:
            return generator.choice([1.0, 2.0, 3.0])
        low, high = self.variables.moderate.get(name, (-1.0, 1.0))
        if low <= 0.0:
            return generator.choice([0.0, generator.uniform(low, high)])
        return math.exp(generator.uniform(math.log(low), math.log(high)))


_Way = Callable[[_Master, int], Call]

_EVERY: tuple[_Way, ...] = (
    _Master._set_up,
    _Master._enter,
    _Master._exit,
    _Master._terminate,
    _Master._reset,
    _Master._free,
    _Master._step,
    _Master._get,
    _Master._set,
    _Master._set_other,
    _Master._set_start_values,
    _Master._get_state,
    _Master._set_state,
    _Master._free_state,
    _Master._free_again,
    _Master._set_freed,
    _Master._set_null,
    _Master._serialize,
    _Master._deserialize,
    _Master._status,
    _Master._cancel,
    _Master._derivatives,
    _Master._debug,
    _Master._version,
)

_ANYWHERE: dict[_Way, float] = {
    _Master._get: 5,
    _Master._get_state: 1.5,
    _Master._set_state: 1.5,
    _Master._free_state: 0.3,
    _Master._free_again: 0.2,
    _Master._set_freed: 0.1,
    _Master._set_null: 0.3,
    _Master._serialize: 0.5,
    _Master._deserialize: 0.7,
    _Master._status: 0.2,
    _Master._cancel: 0.1,
    _Master._derivatives: 0.1,
    _Master._debug: 0.1,
    _Master._version: 0.05,
    _Master._reset: 0.2,
    _Master._free: 0.2,
}


def _usual(ways: dict[_Way, float]) -> tuple[list[_Way], list[float]]:
    together = {**_ANYWHERE, **ways}
    return list(together), list(together.values())


_USUAL = {
    "instantiated": _usual(
        {_Master._set_up: 5, _Master._enter: 15, _Master._set: 6, _Master._set_start_values: 0.5}
    ),
    "initialization": _usual({_Master._set: 6, _Master._exit: 15, _Master._set_start_values: 0.3}),
    "stepping": _usual({_Master._step: 16, _Master._set: 4, _Master._terminate: 0.3}),
    "terminated": _usual(
        {_Master._reset: 3, _Master._free: 2, _Master._terminate: 1, _Master._set: 1.5}
    ),
}
