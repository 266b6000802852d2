"""Lists of value references: read right, however many there are."""

import itertools
from operator import attrgetter

from fmukit.readers import References
from stickslip_fmu.spec import TABLE
from tests.fmu.blocks import make_block


def test_each_of_very_many_lists_is_read_right() -> None:
    """Of 400 lists of references each gives its variables' values, the first one again at last."""
    references = References(TABLE, ("Real", "Integer", "Boolean"), lambda variable: variable.kind)
    block = make_block()
    reals = [number for number, each in enumerate(TABLE.rows) if each.kind == "Real"]
    lists = list(itertools.islice(itertools.permutations(reals, 2), 400))
    for chosen in (*lists, lists[0]):
        values = references.reader("Real", chosen)(block)
        assert list(values) == [attrgetter(TABLE.rows[each].attribute)(block) for each in chosen]
    # What is kept is bounded: an importer may ask for any number of lists.
    assert len(references.readers["Real"]) < len(lists)
