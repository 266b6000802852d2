"""The table of facts, tried on the block, the native FMU, the reference and the truth."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from tests.facts import coulomb, curves, growing
from tests.facts.closed import MP, Exact
from tests.facts.fact import Fact
from tests.facts.sides import Setting, Side, each_side

TRIED = [
    pytest.param(side.values[0], fact, id=f"{side.id}: {fact.statement}", marks=side.marks)
    for fact in (*coulomb.FACTS, *growing.FACTS, *curves.FACTS)
    for side in each_side(fact.sides)
]


@pytest.mark.filterwarnings("ignore::stickslip_ref.FrictionClampWarning")
@pytest.mark.parametrize(("side", "fact"), TRIED)
def test_fact(side: Side, fact: Fact) -> None:
    rows = side.rows(Setting(fact.values, fact.segments, fact.law, fact.start_time))
    expected = fact.expected(Exact(fact.values))
    after = [expected] if isinstance(expected, Mapping) else list(expected)
    for row, outputs in zip(rows[-len(after) :], after, strict=True):
        for name, value in outputs.items():
            got, exact = MP.mpf(float(row[name])) if isinstance(value, int) else row[name], value
            if exact == 0 or isinstance(exact, int):
                assert got == exact, name
            else:
                error = abs(MP.convert(got) / exact - 1)
                assert error <= fact.tolerance(side, name), (name, float(error))
