"""States of the native FMU: handles, and bytes that are never trusted."""

import ctypes as c
import math
import random
import struct
from typing import Any

import pytest

from fmi.table import Table
from stickslip_native.named import native_law
from tests.conftest import Sized, built
from tests.driver import Instance, Refused, loaded
from tests.native.saved import changed, checked, decoded, encoded, fields
from tests.needs import needs

pytestmark = needs("cc")

each_law = pytest.mark.parametrize("law", ["coulomb", "stribeck"])

DAMAGED = 40_000
MOST_SLIPS = 2**31 - 1
RUN = {"c": 3.0, "v": -0.04, "mu_s": 0.4, "mu_k": 0.25, "F_ext": 0.3}
# A curve that falls and rises again, so that a slip is a chain of arcs.
CURVE = {"shape": 3, "n_points": 4, "mu_1": 0.35, "u_2": 0.02, "mu_2": 0.2, "u_3": 0.05}
CURVE |= {"mu_3": 0.15, "u_4": 0.1, "mu_4": 0.2, "mu_k": 0.3}


def running(law: str, steps: int = 40, kind: str = "native-2", **values: float) -> Instance:
    settings = {**RUN, **(CURVE if law == "stribeck" else {}), **values}
    instance = loaded(built(kind, law)).started(1.0, **settings)
    instance.step(0.07, steps)
    return instance


def course(instance: Instance) -> list[dict[str, Any]]:
    shown = []
    for number in range(12):
        if number % 4 == 3:
            instance.set(v=0.01 * number, load=float(number))
        instance.step(0.2)
        shown.append(instance.everything())
    return shown


def table_of(law: str) -> Table:
    return native_law(law).spec.table


def refusal(instance: Instance, data: bytes) -> str:
    """Return why bytes are no state; the instance is as new then."""
    with pytest.raises(Refused) as refused:
        instance.unpack(data)
    instance.reset()
    return refused.value.messages[-1]


@each_law
def test_a_state_is_magic_version_length_fields_little_endian_and_a_checksum(law: str) -> None:
    instance, table = running(law, m=2.0, k=1234.5), table_of(law)
    data = instance.pack()
    found = decoded(data, table)
    assert (found["magic"], found["version"], found["length"]) == (b"slipstat", 3, len(data))
    assert encoded(found, table) == data
    settings = [row.name for row in table.rows if row.settable]
    for group in ("wanted", "settings"):
        assert [found[f"{group}.{name}"] for name in settings] == instance.get(*settings)
    assert found["n_slips"] == instance.get("n_slips")[0] > 2


@each_law
def test_the_bytes_mean_the_same_in_both_versions_of_fmi(law: str) -> None:
    one = running(law)
    data = one.pack()
    two = loaded(built("native-3", law)).instance()
    two.resume(data)
    assert two.pack() == data
    two.time = one.time
    assert course(two) == course(one)


@each_law
def test_a_flipped_bit_or_another_length_is_no_state(law: str) -> None:
    instance = running(law)
    data = instance.pack()
    for bit in range(8 * len(data)):
        damaged = bytearray(data)
        damaged[bit // 8] ^= 1 << bit % 8
        assert refusal(instance, bytes(damaged))
    for length in (*range(len(data)), len(data) + 1, 2 * len(data)):
        cut = (data + data)[:length]
        assert refusal(instance, cut)
        assert refusal(instance, checked(cut[:-8]))


BELOW_ZERO = {"age", "elapsed.high", "t_slip", "t_stick", "T", "Q_friction.high"}
IMPOSSIBLE: dict[str, list[Any]] = {
    "version": [0],
    "length": [0, 2**32 - 1],
    "mode": [-2, 2, MOST_SLIPS],
    "n_slips": [-1],
    "fmi_phase": [-1, 3, 4, 5, 7, MOST_SLIPS],
}


@each_law
def test_no_field_is_taken_with_a_value_that_no_block_reaches(law: str) -> None:
    instance, table = running(law), table_of(law)
    data = instance.pack()
    formats = "<"
    for name, form in fields(table):
        bad = list(IMPOSSIBLE.get(name, []))
        group, _, last = name.partition(".")
        if form == "d":
            bounded = group in ("wanted", "settings") and last in table.by_name
            low = table.by_name[last].minimum if bounded else None
            bad += [math.nan, math.inf]
            bad += [-1.0] if low is not None or name in BELOW_ZERO else []
            bad += [1.0] if last == "low" else []
        for value in bad:
            assert refusal(instance, changed(data, table, {name: value})), (name, value)
        if form == "?":
            at = struct.calcsize(formats)
            assert refusal(instance, checked(data[:at] + b"\2" + data[at + 1 : -8])), name
        formats += form


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"magic": b"SLIPSTAT"}, "the bytes hold no state"),
        ({"version": 1}, "in another format than version 3"),
        ({"names": 0}, "of another friction law"),
        ({"wanted.m": math.nan}, "has not the structure of a state"),
        ({"wanted.m": -1.0}, "m = -1.0 kg is out of range"),
        ({"settings.load": -1e6, "changed": True}, "or the mass lifts off"),
        ({"wanted.m": 5.0}, "no block reaches"),
        ({"mode": 1, "known": False}, "no block reaches"),
        ({"z": 1.7e308, "x_start.high": 1.7e308, "x_start.low": 0.0}, "leave the range of"),
        ({"wanted.shape": 1.5}, "shape = 1.5 is out of range"),
    ],
)
def test_a_refused_state_is_explained(changes: dict[str, Any], words: str) -> None:
    instance = running("stribeck")
    data = changed(instance.pack(), table_of("stribeck"), changes)
    assert words in refusal(instance, data)


def test_a_state_of_another_law_or_fmu_is_refused() -> None:
    two, three = (loaded(built(kind)).instance() for kind in ("native-2", "native-3"))
    other = loaded(built("native-2", "stribeck")).instance()
    assert refusal(other, two.pack()).startswith("a state has ")
    state = two.save()
    for call in (three.restore, three.forget):
        with pytest.raises(Refused, match="is none that this FMU handed out"):
            call(state)
        three.reset()
    two.forget(state)


@each_law
def test_bytes_with_a_fitting_checksum_are_refused_or_a_state_that_runs(
    law: str, sized: Sized
) -> None:
    # Whatever is taken comes back as the same bytes, and runs on in finite numbers or says no.
    chance = random.Random(len(law))
    instance, ended = loaded(built("native-2", law)).instance(), running(law, 9)
    ended.terminate()
    runs = [running(law, steps) for steps in (0, 1, 3, 17, 40)]
    whole = [each.pack() for each in (instance, ended, *runs, running(law, 5, c=0.0, v=0.05))]
    taken = 0
    for _ in range(sized(DAMAGED)):
        damaged = _damaged(chance.choice(whole), chance)
        try:
            instance.resume(damaged)
        except Refused:
            instance.reset()
            continue
        taken += 1
        assert instance.pack() == damaged
        try:
            for number in range(3):
                values = instance.everything().values()
                assert all(map(math.isfinite, values)), damaged.hex()
                instance.set(v=0.01 * number)
                instance.step(chance.choice((1e-3, 0.1, 2.0)))
        except Refused:
            pass
        instance.reset()
    # Most fields may have other values, so the test meets what is taken as well.
    assert 0.1 < taken / sized(DAMAGED) < 0.8


def _damaged(data: bytes, chance: random.Random) -> bytes:
    """Return a state with other bytes, whole numbers or doubles behind its head."""
    body, head = bytearray(data[:-8]), 24
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        kind, at = chance.randrange(4), chance.randrange(head, len(body))
        if kind == 0:
            new = bytes([chance.choice((0, 1, 2, 3, 127, 128, 255))])
        elif kind == 1:
            new = struct.pack("<i", chance.choice((-2, -1, 0, 1, 2, 4, MOST_SLIPS, -(2**31))))
        else:
            # Fields of 8 bytes lie 0, 4, 5 and 6 bytes off multiples of 8.
            at = head + 8 * chance.randrange((len(body) - head) // 8)
            at += chance.choice((0, 0, 4, 5, 1, 6, 2))
            size = 10.0 ** chance.choice((-300, -20, -3, 0, 3, 20, 300))
            value = chance.choice((-1.0, 0.0, 1.0, chance.uniform(-1.0, 1.0))) * size
            if kind == 3:
                value = chance.choice((math.nan, math.inf, -math.inf, 5e-324, -0.0, 1.8e308))
            new = struct.pack("<d", value)
        body[at : at + len(new)] = new[: len(body) - at]
    return checked(bytes(body))


@pytest.mark.parametrize("kind", ["native-2", "native-3"])
def test_a_get_into_a_state_overwrites_it(kind: str) -> None:
    instance = running("coulomb", kind=kind)
    state = instance.save()
    address = state.value
    instance.step(0.3)
    later = instance.everything()
    instance.call("GetFMUstate" if kind == "native-2" else "GetFMUState", c.byref(state))
    assert state.value == address
    instance.step(0.3)
    instance.restore(state)
    assert instance.everything() == later


def test_after_the_largest_count_of_slips_the_count_stays() -> None:
    instance = running("coulomb")
    instance.resume(changed(instance.pack(), table_of("coulomb"), {"n_slips": MOST_SLIPS}))
    before = instance.get("t_event")
    instance.step(5.0)
    assert instance.get("n_slips") == [MOST_SLIPS]
    assert instance.get("t_event") > before


def test_a_step_to_the_end_of_numbers_leaves_a_state() -> None:
    instance = loaded(built("native-2")).started(v=0.0)
    instance.time = 1.5e308
    instance.step(1e308)
    instance.resume(instance.pack())
