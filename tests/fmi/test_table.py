"""Tables that contradict themselves, and the record of values that a table gives."""

import copy
from typing import Any

import pytest

from fmi.model import ModelError
from fmi.plain import check, values
from fmi.table import ABOVE_ZERO, Quantity, Table, Unit, Values, Variable

MASS, COUNT = Quantity("Mass", "Real", "Mass", "kg"), Quantity("Count", "Integer")
UNITS = {"kg": Unit({"kg": 1})}


def row(number: int, name: str, **other: Any) -> Variable:
    given = {"type": MASS, "causality": "parameter", "variability": "fixed", "start": 1.0}
    return Variable(number, name, **{**given, "description": name, **other})


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ([row(0, "a"), row(0, "b")], "b: number 0 where 1 is due"),
        ([row(0, "a"), row(2, "b")], "b: number 2 where 1 is due"),
        ([row(0, "a"), row(1, "a")], "a: the name is given twice"),
        ([row(0, "a b")], "a b: the name is no Python identifier"),
        ([row(0, "lambda")], "lambda: the name is no Python identifier"),
        ([row(0, "time")], "time: the name is that of the independent variable"),
        ([row(0, "a", type=Quantity("Weight", "Real"))], "a: the quantity Weight is not in"),
        ([row(0, "a", depends=("b",))], "a: depends on b, which is not in the table"),
        ([row(0, "a", causality="local")], "a: the causality local is none of parameter, input"),
        ([row(0, "a", variability="often")], "a: the variability often is none of fixed"),
        ([row(0, "a", minimum=2.0, maximum=1.0)], "a: the minimum 2.0 is above the maximum 1.0"),
        ([row(0, "a", type=COUNT, start=1.5)], "a: the start value 1.5 of an Integer is no whole"),
        ([row(0, "a", start=None)], "a: a parameter or input needs a start value"),
        ([row(0, "a", minimum=2.0)], "a: a = 1.0 kg is out of range: .* and at least 2"),
    ],
)
def test_a_row_that_contradicts_itself_or_others_is_refused(rows: list[Any], told: str) -> None:
    with pytest.raises(ValueError, match="^" + told):
        Table(UNITS, [MASS, COUNT], rows)


@pytest.mark.parametrize(
    ("units", "quantities", "told"),
    [
        ({}, [MASS], "Mass: the unit kg is not in the table"),
        (UNITS, [MASS, MASS], "two quantities have one name"),
        (UNITS, [Quantity("Text", "String")], "Text: String is none of Real, Integer, Boolean"),
    ],
)
def test_units_and_quantities_must_fit(units: Any, quantities: Any, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        Table(units, quantities, [])


TABLE = Table(
    UNITS,
    [MASS, COUNT],
    [
        row(2, "shown", causality="output", start=None),
        row(1, "n", type=COUNT, start=3, minimum=0, maximum=5),
        row(0, "m", minimum=ABOVE_ZERO, start=1),
    ],
)


class Given(Values, table=TABLE):
    """Values with a method of their own."""

    def double(self) -> float:
        return 2.0 * self.m


def test_rows_stand_in_the_order_of_their_numbers() -> None:
    assert [each.name for each in TABLE.rows] == ["m", "n", "shown"]
    assert TABLE.by_name["n"].number == 1
    assert Given.names == ("m", "n")


def test_a_saved_state_compares_types_so_values_have_those_of_their_rows() -> None:
    assert type(TABLE.rows[0].start) is float
    record = Given({"m": 2.0, "n": 4.0})
    assert [type(record.m), type(record.n)] == [float, int]


def test_values_change_by_copies() -> None:
    start = Given.at_start()
    heavy = start.changed("m", 4.0)
    assert (start.m, heavy.m, heavy.n, heavy.double()) == (1.0, 4.0, 3.0, 8.0)
    assert type(heavy) is Given
    assert copy.deepcopy(heavy).as_dict() == {"m": 4.0, "n": 3}


def test_a_record_for_a_longer_table_keeps_the_methods_of_the_shorter_ones() -> None:
    class More(Given, table=Table(UNITS, [MASS, COUNT], [*TABLE.rows, row(3, "more")])):
        """One value more."""

    found = More.at_start().changed("more", 7.0).changed("m", 2.0)
    assert (found.m, found.n, found.more, found.double()) == (2.0, 3, 7.0, 4.0)
    assert type(found) is More
    with pytest.raises(ValueError, match="double: Bad has another attribute of this name"):

        class Bad(Given, table=Table(UNITS, [MASS, COUNT], [*TABLE.rows, row(3, "double")])):
            """A value with the name of a method."""


@pytest.mark.parametrize(
    ("plain", "told"),
    [
        ({"m": 1.0}, "structure"),
        ({"m": 1.0, "n": 3, "o": 1.0}, "structure"),
        ({"m": 1, "n": 3}, "structure"),
        ({"m": 1.0, "n": 3.0}, "structure"),
        ({"m": float("inf"), "n": 3}, "structure"),
        ({"m": 0.0, "n": 3}, "m = 0.0 kg is out of range: it must be finite and above 0"),
        ({"m": 1.0, "n": 6}, "n = 6 is out of range: .* at least 0 and at most 5"),
        ([], "structure"),
    ],
)
def test_saved_values_that_do_not_fit_the_table_are_refused(plain: Any, told: str) -> None:
    with pytest.raises(ModelError, match=told):
        values(Given, plain)


def test_a_tuple_in_the_pattern_of_saved_data_allows_any_of_its_members() -> None:
    pattern = {"force": (0.0, None), "parts": [0, ""]}
    for good in (1.5, None):
        check({"force": good, "parts": [1, "a"]}, pattern)
    for bad in (1, "1", [1.5]):
        with pytest.raises(ModelError):
            check({"force": bad, "parts": [1, "a"]}, pattern)
