"""Random sequences of calls, as a careless master might make them, and what they must give."""

import math
import random
from typing import Any

from tests.driver import OK
from tests.fmu.lives.contract import Contract, Expected
from tests.fmu.lives.player import SKIPPED, Call

_NOT_FINITE = (math.nan, math.inf, -math.inf)
# Of k and m the extremes keep the slips far longer or far shorter than any step: in between a
# step may rightly hold millions of transitions.
_EXTREME = (1e300, 1.7e308, 1e-300, 2.3e-308, 5e-324, -0.0, -1e-300, -1.0, -1e300)
_STEPS = (1e-300, 5e-324, 1e-13, 1.7e-13, 1e-9, 3e-6)
_BAD_STEPS = (0.0, -0.0, -1e-300, -0.01, *_NOT_FINITE)
_HUGE_STEPS = (1e17, 1e300)
_STARTS = (0.0, 0.0, 5.0, -3.0, 1e9)
_NAMES = ("a", "%", "%s%n", "%d%%", "Ruckgleiten é", "摩擦 🧱", "", "x" * 300)
_TEXTS = ("", "x", "%n%s", "ä")
_INTEGERS = (0, 0, 1, -1, 4, 13, 2**31 - 1, -(2**31))

# Where next to nothing is refused; other variables follow from start value or nominal.
_MODERATE = {
    "m": (0.1, 10.0),
    "g": (1.0, 20.0),
    "k": (10.0, 1e4),
    "c": (0.0, 5.0),
    "load": (-12.0, 50.0),
    "z_start": (-0.05, 0.05),
    "B": (0.0, 0.1),
    "t_0": (1e-3, 10.0),
    "age_start": (0.0, 100.0),
    "v_s": (1e-3, 1.0),
    "delta": (1.0, 4.0),
    "mu_1": (0.0, 0.4),
    # Speeds of a curve mostly rise, whichever of them are set.
    **{f"u_{n}": (0.1 * n - 0.16, 0.1 * n - 0.04) for n in range(2, 13)},
}
# Values that return, so that a warning may be due again.
_ROUND = {"delta": (1.0, 2.0, 3.0), "mu_s": (0.2, 0.5), "mu_k": (0.3, 0.6)}
# Weights of the calls that are made in each phase, and anywhere.
_ANYWHERE = {"get": 5.0, "save": 1.5, "restore": 1.5, "pack": 0.6, "unpack": 0.8, "forget": 0.4}
_ANYWHERE |= {"forget_again": 0.2, "restore_freed": 0.1, "reset": 0.2, "free": 0.2, "wrong": 0.05}
_USUAL: dict[str, dict[str, float]] = {
    "instantiated": {"set_up": 5, "enter": 15, "set": 7},
    "initialization": {"set": 7, "exit": 15},
    "stepping": {"step": 16, "set": 4, "terminate": 0.3},
    "terminated": {"reset": 3, "free": 2, "terminate": 1, "wrong": 0.5},
    "failed": {"reset": 4, "free": 1, "step": 2, "set": 1, "terminate": 1, "exit": 1},
}


class Master:
    """A careless master with its instances; these and places for states count from `mark` on."""

    def __init__(self, kind: str, law: str, seed: int, mark: int = 0) -> None:
        self.mark = mark
        self.contract = Contract(kind, law)
        self.chance = random.Random(seed)
        self.rows = self.contract.rows
        self.types: dict[str, list[int]] = {"String": []}
        for row in self.rows:
            self.types.setdefault(self.contract.type_of(row.number), []).append(row.number)
        if self.contract.face == 3:
            self.types["Float64"].append(len(self.rows))
            self.types["UInt64"] = []
        # Careful masters meet the deep states, careless ones the refusals.
        self.mistakes = self.chance.choice([0.0, 0.01, 0.05, 0.3])
        self.instances = self.chance.choice([1, 1, 1, 2, 3])
        # Calls, each with the phase or mode in which it was made.
        self.taken: set[tuple[str, str]] = set()
        self.refused: set[tuple[str, str]] = set()

    def life(self) -> list[tuple[Call, Expected]]:
        made = []
        for _ in range(self.chance.randint(5, 60)):
            i, where = self.mark + self.chance.randrange(self.instances), "nowhere"
            call: Call = ["instantiate", i, self.chance.choice(_NAMES)]
            if i in self.contract.lives:
                call, where = self._call(i), self.contract.where(i)
            expected = self.contract.expected(call)
            if expected.status != SKIPPED:
                (self.taken if expected.status == OK else self.refused).add((call[0], where))
            made.append((call, expected))
        return made

    def _call(self, i: int) -> Call:
        life = self.contract.lives[i]
        phase = "failed" if life.fault is not None else life.phase
        if self._errs():
            phase = self.chance.choice(list(_USUAL))
        weights = {**_ANYWHERE, **_USUAL[phase]}
        (name,) = self.chance.choices(list(weights), list(weights.values()))
        if name == "wrong":
            return self._set_what_cannot_be_set(i)
        return [name, i, *getattr(self, f"_{name}", list)(*([life] if name == "step" else []))]

    def _errs(self) -> bool:
        return self.chance.random() < self.mistakes

    def _set_up(self) -> list[Any]:
        start = self.chance.choice(_NOT_FINITE if self._errs() else _STARTS)
        return [start, self.chance.choice([None, None, 10.0, -1.0, math.nan])]

    def _enter(self) -> list[Any]:
        return [self.chance.choice(_NOT_FINITE if self._errs() else _STARTS)]

    def _step(self, life: Any) -> list[Any]:
        chance = self.chance
        step = chance.choice([10.0 ** chance.uniform(-4.0, -0.5)] * 5 + [2.0])
        if chance.random() < 0.1:
            step = chance.choice(_STEPS)
        elif self._errs():
            step = chance.choice(_BAD_STEPS)
        elif chance.random() < 0.006:
            step = chance.choice(_HUGE_STEPS)
        time = chance.choice([0.0, -1.0, 1e300, *_NOT_FINITE]) if self._errs() else life.time
        return [time, step]

    def _get(self) -> list[Any]:
        kind = self.chance.choices(list(self.types), [6 * bool(x) + 1 for x in self.types.values()])
        references = list(self.types[kind[0]])
        if references and self.chance.random() < 0.7:
            references = self.chance.choices(references, k=self.chance.randint(0, 5))
        return [kind[0], self._misled(references)]

    def _set(self) -> list[Any]:
        chance, rows = self.chance, self.rows
        if chance.random() < 0.05:
            # All start values, as some importers write them back.
            kind = self.contract.type_of(0)
            starts = [row for row in rows if row.kind == "Real" and row.start is not None]
            return [kind, [row.number for row in starts], [row.start for row in starts]]
        kinds = {self.contract.type_of(row.number) for row in rows if row.settable}
        kind = chance.choice([self.contract.type_of(0), *sorted(kinds)])
        settable = [n for n in self.types[kind] if n < len(rows) and rows[n].settable]
        if all(life.phase == "stepping" for life in self.contract.lives.values()):
            # Mostly what may be set between two steps.
            settable = [n for n in settable if rows[n].variability != "fixed"] or settable[:1]
        references = chance.choices(settable, k=chance.choice([0, 1, 1, 2, 4, 8]))
        references = self._misled(references)
        value = self._whole if kind.startswith("Int") else self._real
        return [kind, references, [value(each) for each in references]]

    def _set_what_cannot_be_set(self, i: int) -> Call:
        kind = self.chance.choice(sorted(self.types))
        references = self.chance.choices(self.types[kind] or [0], k=self.chance.randint(0, 1))
        choices: tuple[Any, ...] = _TEXTS if kind == "String" else _INTEGERS
        if kind in ("Real", "Float64"):
            choices = (0.0, 1.0, -1.0)
        return ["set", i, kind, references, [self.chance.choice(choices) for _ in references]]

    def _save(self) -> list[Any]:
        return [self._slot()]

    _restore = _forget = _forget_again = _restore_freed = _save

    def _pack(self) -> list[Any]:
        return [self._slot(), self._slot()]

    def _unpack(self) -> list[Any]:
        damage = self.chance.choice(["cut", "empty", "garbage"]) if self._errs() else ""
        return [self._slot(), self._slot(), damage]

    def _slot(self) -> int:
        return self.mark + self.chance.randrange(2)

    def _misled(self, references: list[int]) -> list[int]:
        if not self._errs():
            return references
        count = len(self.rows)
        # Behind the time there are derivatives and indicators.
        wrong = self.chance.choice([count, count + 9, 2**31, 2**32 - 1, *range(count)])
        at = self.chance.randint(0, len(references))
        return [*references[:at], wrong, *references[at:]]

    def _whole(self, reference: int) -> int:
        row = self.rows[min(reference, len(self.rows) - 1)]
        if row.kind != "Integer" or self._errs():
            return self.chance.choice(_INTEGERS)
        return self.chance.randint(int(row.minimum or 0), int(row.maximum or 0))

    def _real(self, reference: int) -> float:
        chance = self.chance
        row = self.rows[min(reference, len(self.rows) - 1)]
        if self._errs():
            return chance.choice(_NOT_FINITE + _EXTREME)
        if row.name in _ROUND and chance.random() < 0.5:
            return chance.choice(_ROUND[row.name])
        scale = row.type.nominal
        low, high = _MODERATE.get(row.name, (-3.0 * scale if row.minimum is None else 0.0, scale))
        if low <= 0.0:
            return chance.choice([0.0, chance.uniform(low, high)])
        return math.exp(chance.uniform(math.log(low), math.log(high)))
