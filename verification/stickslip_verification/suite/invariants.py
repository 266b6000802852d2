"""Invariants: data files, read, checked and turned into frozen objects."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from typing import Any

from stickslip_verification.model.data_file import DataError, objection, read_toml
from stickslip_verification.model.verdict import Kind, Klass
from stickslip_verification.suite import schemas

HERE = Path(__file__).parent
FOLDER = HERE / "invariants"


class InvariantError(DataError):
    """A file of invariants cannot be used; one line with the file, the invariant and the reason."""


@dataclass(frozen=True)
class Invariant:
    """One statement that is tried on every case, or once.

    Attributes
    ----------
    id, title
        Its name, and the statement in words.
    kind, klass
        Kind of truth, and physics or contract.
    source
        Equation number in docs/theory.md.
    means, look
        What it means when it fails, and where to look then.
    laws
        Names of the friction laws that it holds for; empty: all.
    """

    id: str
    title: str
    kind: Kind
    klass: Klass
    source: int
    means: str
    look: str
    laws: Sequence[str] = field(default=(), kw_only=True)

    def holds_for(self, law: str) -> bool:
        """Whether it holds for the friction law of this name."""
        return not self.laws or law in self.laws


@dataclass(frozen=True)
class ResidualInvariant(Invariant):
    """An invariant on the samples: `metric` (a key of `METRICS`) leaves nothing over.

    ``tolerance`` and ``because`` are by side, as parts of the metric's scale.
    """

    metric: str
    quantity: str
    tolerance: Mapping[str, float]
    because: Mapping[str, str]


@dataclass(frozen=True)
class RunInvariant(Invariant):
    """Another run of the FMU (a key of `RUNS`) gives the same motion.

    ``tolerance`` is that of the exact block, as a part of each output's largest value; None: bit
    for bit.
    """

    run: str
    tolerance: float | None
    because: str


@dataclass(frozen=True)
class Manner(Invariant):
    """The exact motion of random sequences, in a manner of calling the FMU (a key of `MANNERS`)."""

    manner: str


@dataclass(frozen=True)
class Probe(Invariant):
    """A question to the FMU as a whole: a key of `PROBES` and its arguments."""

    probe: str
    arguments: Mapping[str, Any]


@dataclass(frozen=True)
class Agreement(Invariant):
    """FMU and reference agree on `quantity`, within what the case allows both together."""

    quantity: str


@dataclass(frozen=True)
class Order(Invariant):
    """The reference's error in `quantity` falls with its tolerance in the order `order`.

    Tried on `cases` with `levels` tolerances from `coarsest` to `finest`, evenly spaced in their
    logarithm. ``tolerance`` is on the slope through all levels, ``halves`` on the difference of
    the slopes of the coarser and the finer half, which is 0 in the asymptotic range.
    """

    quantity: str
    cases: Sequence[str]
    order: float
    coarsest: float
    finest: float
    levels: int
    tolerance: float
    halves: float
    because: Mapping[str, str]


@dataclass(frozen=True)
class Invariants:
    """All invariants, by the way they are tried."""

    residuals: Sequence[ResidualInvariant] = ()
    runs: Sequence[RunInvariant] = ()
    sequences: Sequence[Manner] = ()
    probes: Sequence[Probe] = ()
    agreements: Sequence[Agreement] = ()
    orders: Sequence[Order] = ()

    def __iter__(self) -> Iterator[Invariant]:
        """Yield every invariant."""
        for each in fields(self):
            yield from getattr(self, each.name)

    def only(self, names: Collection[str]) -> Invariants:
        """Return those of these ids."""
        families = {each.name: getattr(self, each.name) for each in fields(self)}
        return Invariants(
            **{
                family: [invariant for invariant in of if invariant.id in names]
                for family, of in families.items()
            }
        )

    def of_laws(self, laws: Collection[str]) -> Invariants:
        """Return those that hold for one of these friction laws."""
        return self.only({each.id for each in self if any(each.holds_for(law) for law in laws)})


_SHARED: Mapping[str, Mapping[str, Any]] = {
    "probes": {"kind": Kind.INVARIANT, "class": Klass.CONTRACT, "source": 1, "arguments": {}},
    "agreements": {
        "kind": Kind.CROSS_CODE,
        "class": Klass.PHYSICS,
        "source": 3,
        "means": "FMU and reference give different values: one of them is wrong, or both are.",
        "look": "The bug is on the side that fails the case's checks against the exact motion.",
    },
    "orders": {"kind": Kind.CONVERGENCE, "class": Klass.PHYSICS},
    "runs": {"tolerance": None},
}
"""What all entries of a family have in common, and so is not written in the files."""

_FAMILIES: Mapping[str, type[Invariant]] = {
    "residuals": ResidualInvariant,
    "runs": RunInvariant,
    "sequences": Manner,
    "probes": Probe,
    "agreements": Agreement,
    "orders": Order,
}


def load_invariants(folder: Path = FOLDER) -> Invariants:
    """Read every TOML file of a folder, in the order of their names.

    Raises
    ------
    InvariantError
        A file is broken, or two invariants share an id.
    """
    families: dict[str, list[Any]] = {family: [] for family in _FAMILIES}
    seen: dict[str, Path] = {}
    for file in sorted(folder.glob("*.toml")):
        for family, invariant in _read(file):
            if invariant.id in seen:
                raise InvariantError(
                    file, invariant.id, f"an invariant of {seen[invariant.id].name} has this id"
                )
            seen[invariant.id] = file
            families[family].append(invariant)
    return Invariants(**{family: tuple(invariants) for family, invariants in families.items()})


@cache
def invariant_ids() -> frozenset[str]:
    """Return the ids of the suite's invariants, and those of the results that they give."""
    invariants = load_invariants()
    return frozenset(
        {each.id for each in invariants} | {f"{each.id}-asymptotic" for each in invariants.orders}
    )


def _read(file: Path) -> Iterator[tuple[str, Invariant]]:
    data = read_toml(file, InvariantError)
    found = objection(data, schemas.INVARIANTS)
    if found is not None:
        raise InvariantError(file, _place(found[0], data), found[1])
    for family, entries in data.items():
        for entry in entries:
            _check_finite(file, entry)
            yield family, _invariant(family, entry)


def _check_finite(file: Path, entry: Mapping[str, Any]) -> None:
    """Refuse tolerances and levels that are no numbers; arguments of probes may be anything."""
    for name, value in entry.items():
        values = value.items() if name == "tolerance" and isinstance(value, dict) else [("", value)]
        for part, number in values:
            if isinstance(number, float) and not math.isfinite(number):
                where = ".".join(filter(None, (str(entry["id"]), name, part)))
                raise InvariantError(file, where, f"{number} is not a finite number")


def _invariant(family: str, entry: Mapping[str, Any]) -> Invariant:
    values = {**_SHARED.get(family, {}), **entry}
    values["kind"], values["klass"] = Kind(values["kind"]), Klass(values.pop("class"))
    return _FAMILIES[family](**values)


def _place(path: Iterable[str | int], data: Mapping[str, Any]) -> str:
    """Name the invariant that a path of the schema leads to, and the field in it."""
    parts = list(path)
    if len(parts) < 2:
        return ".".join(map(str, parts))
    family, number, *rest = parts
    name = data[str(family)][number].get("id", f"entry {number}")
    return ".".join(map(str, (name, *rest)))
