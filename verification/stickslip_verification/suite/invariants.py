"""Invariants: what every run must satisfy, read from data files."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Annotated, Any, ClassVar

from pydantic import Field
from pydantic.dataclasses import dataclass

from ..model import data_file as data
from ..model.verdict import Kind, Klass

FOLDER = Path(__file__).parent / "invariants"

Name = Annotated[str, Field(pattern="^[a-z_]+$")]
Equation = Annotated[data.Ordinal, Field(description="number in docs/theory.md")]
OnSides = data.keyed("fmu", "reference")


class InvariantError(data.DataError):
    """A file of invariants cannot be used."""


@dataclass(frozen=True, kw_only=True, config=data.WRITTEN)
class Invariant(data.Written):
    """One statement that is tried on every case, or once."""

    id: data.Id = ""
    title: Annotated[data.Text, Field(description="the statement")]
    kind: Kind = Kind.INVARIANT
    klass: Annotated[Klass, Field(validation_alias="class")] = Klass.PHYSICS
    source: Equation
    means: Annotated[data.Text, Field(description="the meaning of its failure")]
    look: Annotated[data.Text, Field(description="where the bug is likely")]
    laws: Annotated[tuple[data.Text, ...], Field(description="friction laws; empty: all")] = ()
    stays: Annotated[str, Field(description="reason to stay though it detects no fault")] = ""

    def holds_for(self, law: str) -> bool:
        """Whether it holds for the friction law of this name."""
        return not self.laws or law in self.laws


@dataclass(frozen=True, kw_only=True, config=data.WRITTEN)
class ResidualInvariant(Invariant):
    """An invariant on the samples: `metric` (a key of `METRICS`) leaves nothing over.

    ``tolerance`` and ``because`` are by side, as parts of the metric's scale.
    """

    metric: Annotated[str, Field(pattern=r"^[a-z]+\.[a-z_]+$")]
    quantity: data.Text
    tolerance: Annotated[Mapping[str, data.Amount], OnSides]
    because: Annotated[Mapping[str, data.Text], OnSides]


@dataclass(frozen=True, kw_only=True, config=data.WRITTEN)
class RunInvariant(Invariant):
    """Another run of the FMU (a key of `RUNS`) gives the same motion.

    ``tolerance`` is that of the exact block, as a part of each output's largest value; None: bit
    for bit. One that is ``numerical`` is tried on numerical solutions only, within rounding.
    """

    run: Name
    numerical: bool = False
    tolerance: data.Amount | None = None
    because: data.Text


@dataclass(frozen=True, kw_only=True, config=data.WRITTEN)
class Manner(Invariant):
    """The exact motion of random sequences, in a manner of calling the FMU (a key of `MANNERS`)."""

    manner: Name


@dataclass(frozen=True, kw_only=True, config=data.WRITTEN)
class Probe(Invariant):
    """A question to the FMU as a whole: a key of `PROBES` and its arguments."""

    klass: Annotated[Klass, Field(validation_alias="class")] = Klass.CONTRACT
    source: Equation = 1
    probe: Name
    arguments: Mapping[str, Any] = Field(default_factory=dict)


@dataclass(frozen=True, kw_only=True, config=data.WRITTEN)
class Agreement(Invariant):
    """FMU and reference agree on `quantity`, within what the case allows both together."""

    kind: Kind = Kind.CROSS_CODE
    source: Equation = 3
    means: data.Text = "FMU and reference give different values: one of them is wrong, or both are."
    look: data.Text = (
        "The bug is on the side that fails the case's checks against the exact motion."
    )
    quantity: data.Text


@dataclass(frozen=True, kw_only=True, config=data.WRITTEN)
class Order(Invariant):
    """The reference's error in `quantity` falls with its tolerance in the order `order`.

    Tried on `cases` with `levels` tolerances from `coarsest` to `finest`, evenly spaced in their
    logarithm. ``tolerance`` is on the slope through all levels, ``halves`` on the difference of
    the slopes of the coarser and the finer half, which is 0 in the asymptotic range.
    """

    kind: Kind = Kind.CONVERGENCE
    quantity: data.Text
    cases: Annotated[tuple[data.Id, ...], Field(min_length=1)]
    order: data.Positive
    coarsest: data.Positive
    finest: data.Positive
    levels: Annotated[int, Field(ge=5)]
    tolerance: data.Amount
    halves: data.Amount
    because: Annotated[Mapping[str, data.Text], data.keyed("order", "halves")]


@dataclass(frozen=True, config=data.WRITTEN)
class Invariants(data.Written):
    """Invariants that every run of the stick-slip block is held to, by the way they are tried."""

    SOME: ClassVar = ("residuals", "runs", "sequences", "probes", "agreements", "orders")

    residuals: data.ById[ResidualInvariant] = ()
    runs: data.ById[RunInvariant] = ()
    sequences: data.ById[Manner] = ()
    probes: data.ById[Probe] = ()
    agreements: data.ById[Agreement] = ()
    orders: data.ById[Order] = ()

    def __iter__(self) -> Iterator[Invariant]:
        for family in self.SOME:
            yield from getattr(self, family)

    def only(self, names: Collection[str]) -> Invariants:
        """Return those of these ids."""
        families = ((family, getattr(self, family)) for family in self.SOME)
        return Invariants(**{name: [i for i in of if i.id in names] for name, of in families})


def load_invariants(folder: Path = FOLDER) -> Invariants:
    """Read every TOML file of a folder, in the order of their names.

    `InvariantError` if a file is broken, or two invariants share an id.
    """
    families: dict[str, list[Any]] = {family: [] for family in Invariants.SOME}
    files: dict[str, Path] = {}
    for path in sorted(folder.glob("*.toml")):
        file = data.DataFile(path, InvariantError)
        written = file.read(Invariants)
        for family, invariants in families.items():
            for invariant in getattr(written, family):
                if first := files.get(invariant.id):
                    reason = f"{first.name} has an invariant of this id"
                    raise file.refusal(reason, family, invariant.id)
                files[invariant.id] = path
                invariants.append(invariant)
    return Invariants(**families)


@cache
def invariant_ids() -> frozenset[str]:
    """Return the ids of the suite's invariants, and those of the results that they give."""
    invariants = load_invariants()
    asymptotic = {f"{order.id}-asymptotic" for order in invariants.orders}
    return frozenset({invariant.id for invariant in invariants} | asymptotic)
