"""States of the native FMU: handles, and bytes that are never trusted."""

import ctypes
import math
import random
import struct
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.native.conftest import EACH, LAWS, Native
from tests.native.library import ERROR, OK, REFERENCE, Library
from tests.needs import needs

pytestmark = needs("cc")

DAMAGED = 100_000
_FIELDS = 24
_COMMON = {"c": 3.0, "v": -0.04, "mu_s": 0.4, "mu_k": 0.25, "F_ext": 0.3}
# A curve that falls and rises again, so that a slip is a chain of arcs.
_CURVE = {"shape": 3, "n_points": 4, "mu_1": 0.35, "u_2": 0.02, "mu_2": 0.2, "u_3": 0.05}
_CURVE |= {"mu_3": 0.15, "u_4": 0.1, "mu_4": 0.2, "mu_k": 0.3}
_RUNNING: dict[str, dict[str, float]] = {
    "StickSlip": _COMMON,
    "StickSlipStribeck": {**_COMMON, **_CURVE},
}


def _settable(library: Library) -> int:
    """Return how many settings there are: their bytes stand three times in a state."""
    return sum(row.settable for row in library.table.rows)


def _holding(library: Library) -> int:
    """Return where the settings that hold stand: behind those that are wanted."""
    return _FIELDS + 8 * _settable(library)


def _values(library: Library) -> int:
    """Return where the values of the instance stand, from the end: before time and phase."""
    return -8 - 1 - 4 - 8 - 8 * _settable(library)


def _slips(library: Library) -> int:
    """Return where n_slips stands: behind the start of the arc, five sums and seven quantities."""
    return _holding(library) + 8 * _settable(library) + 5 + 8 * 8 + 8 * 10 + 8 * 7


@pytest.fixture(scope="module", params=EACH, ids=lambda each: f"{each[1]}-{each[0]}")
def library(
    request: pytest.FixtureRequest, native: Native, tmp_path_factory: pytest.TempPathFactory
) -> Library:
    """Give the library of each face and law."""
    return Library(native(*request.param), tmp_path_factory.mktemp("library"))


def _started(library: Library, steps: int = 40, **values: float) -> ctypes.c_void_p:
    """Return an instance in mid-run."""
    instance = library.instantiate()
    assert library.start(instance, 1.0, **{**_RUNNING[library.path.stem], **values}) == OK
    for number in range(steps):
        assert library.step(instance, 1.0 + 0.07 * number, 0.07) == OK
    return instance


def _following(library: Library, instance: ctypes.c_void_p) -> list[bytes]:
    """Return the bits of all outputs of the steps that follow."""
    shown = []
    for number in range(30):
        status, values = library.get(instance)
        assert status == OK
        shown.append(struct.pack(f"<{len(values)}d", *values))
        if number % 10 == 9:
            assert library.set(instance, {"v": 0.01 * number, "load": float(number)}) == OK
        assert library.step(instance, 0.1 * number, 0.1) == OK
    return shown


def _checked(content: bytes) -> bytes:
    """Return bytes with the checksum that fits them: FNV-1a of 64 bits."""
    value = 14695981039346656037
    for byte in content[:-8]:
        value = (value ^ byte) * 1099511628211 % 2**64
    return content[:-8] + struct.pack("<Q", value)


def test_the_checksum_of_these_tests_is_that_of_the_fmu(library: Library) -> None:
    """What _checked repairs is whole again."""
    content = library.packed(_started(library))
    assert _checked(content[:-8] + bytes(8)) == content


def test_a_state_brings_back_the_motion_to_the_bit(library: Library) -> None:
    """A handle, and the bytes of a state on a new instance, go on as the run itself.

    States are taken along a run whose input changes within slips.
    """
    instance, other = _started(library, 30), library.instantiate()
    for number in range(80):
        assert library.set(instance, {"v": -0.04 - 0.001 * (number % 3)}) == OK
        assert library.step(instance, 0.02 * number, 0.02) == OK
        content = library.packed(instance)
        status, state = library.take(instance)
        assert status == OK
        expected = _following(library, instance)
        read, unpacked = library.unpacked(other, content)
        assert (read, library.put(other, unpacked)) == (OK, OK)
        assert library.packed(other) == content
        assert _following(library, other) == expected
        assert library.put(instance, state) == OK
        assert _following(library, instance) == expected
        assert library.put(instance, state) == OK
        assert [library.free(other, each) for each in (state, unpacked)] == [OK, OK]


def test_a_state_before_the_start_keeps_what_was_set(library: Library) -> None:
    """A state of the initialization brings back the values, also those not shown yet."""
    instance = library.instantiate()
    assert library.set(instance, {"z_start": 0.002, "x_start": 5.0}) == OK
    content = library.packed(instance)
    # They are checked as those of a block are.
    other = library.instantiate()
    at = _values(library)
    changed = content[:at] + struct.pack("<d", -1.0) + content[at + 8 :]
    assert library.unpacked(other, _checked(changed))[0] == ERROR
    assert library.told[-1][3].startswith("m = -1.0 kg is out of range")
    other = library.instantiate()
    read, state = library.unpacked(other, content)
    assert (read, library.put(other, state)) == (OK, OK)
    assert library.get(other, [6, 8, 12, 15]) == (OK, [5.0, 0.002, 5.0, 0.002])
    assert library.start(other) == OK


@pytest.mark.parametrize("law", LAWS)
def test_both_faces_read_the_same_bytes(native: Native, tmp_path: Path, law: str) -> None:
    """The bytes of a state mean the same in FMI 2.0 and 3.0."""
    two = Library(native(2, law), tmp_path / "2")
    three = Library(native(3, law), tmp_path / "3")
    instance = _started(two)
    content = two.packed(instance)
    other = three.instantiate()
    read, state = three.unpacked(other, content)
    assert (read, three.put(other, state)) == (OK, OK)
    assert three.packed(other) == content
    assert _following(three, other) == _following(two, instance)


def test_the_bytes_are_the_same_on_every_machine(library: Library) -> None:
    """Magic, version, length and the settings stand where the format says, little-endian."""
    instance = library.instantiate()
    assert library.start(instance, m=2.0, k=1234.5) == OK
    content = library.packed(instance)
    assert content[:8] == b"slipstat"
    assert struct.unpack("<II", content[8:16]) == (1, len(content))
    names = [row.name for row in library.table.rows if row.settable]
    settings = struct.unpack_from(f"<{len(names)}d", content, _FIELDS)
    expected = {**library.table.start_values(), "m": 2.0, "k": 1234.5}
    assert settings == tuple(expected[name] for name in names)


def test_the_bytes_of_one_law_are_none_of_another(native: Native, tmp_path: Path) -> None:
    """A state tells the friction law by the names of its settings, or already by its length."""
    ours = Library(native(2), tmp_path / "ours")
    theirs = Library(native(2, "stribeck"), tmp_path / "theirs")
    instance = theirs.instantiate()
    assert theirs.unpacked(instance, ours.packed(ours.instantiate()))[0] == ERROR
    assert theirs.told[-1][3].startswith("a state has ")


def test_a_whole_number_in_a_state_is_whole(native: Native, tmp_path: Path) -> None:
    """Bytes whose shape lies between two shapes, or beyond them, hold no state."""
    library = Library(native(2, "stribeck"), tmp_path)
    settable = [row.name for row in library.table.rows if row.settable]
    at = _FIELDS + 8 * settable.index("shape")
    instance = library.instantiate()
    content = library.packed(instance)
    for shape, said in ((1.5, "shape = 1.5 is out of range"), (4.0, "shape = 4 is out of range")):
        changed = content[:at] + struct.pack("<d", shape) + content[at + 8 :]
        assert library.unpacked(instance, _checked(changed))[0] == ERROR
        assert library.told[-1][3].startswith(said)
        assert library.call("Reset", instance) == OK


def test_every_flipped_bit_is_refused(library: Library) -> None:
    """Bytes with one changed bit are no state."""
    instance = _started(library)
    content = library.packed(instance)
    for bit in range(8 * len(content)):
        damaged = bytearray(content)
        damaged[bit // 8] ^= 1 << bit % 8
        status, state = library.unpacked(instance, bytes(damaged))
        assert (status, state.value) == (ERROR, None), bit
        assert library.call("Reset", instance) == OK


def test_every_other_length_is_refused(library: Library) -> None:
    """Bytes that were cut or have a tail are no state, whatever their checksum."""
    instance = _started(library)
    content = library.packed(instance)
    for length in (*range(len(content)), len(content) + 1, 2 * len(content)):
        cut = (content + content)[:length]
        for given in (cut, _checked(cut) if length >= 16 else cut):
            status, _ = library.unpacked(instance, given)
            assert status == ERROR, length
            assert library.call("Reset", instance) == OK


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda bytes_: b"SLIPSTAT" + bytes_[8:], "the bytes hold no state"),
        (lambda bytes_: bytes_[:8] + struct.pack("<I", 2) + bytes_[12:], "than version 1"),
        (lambda bytes_: bytes_[:16] + bytes(8) + bytes_[24:], "of another friction law"),
        (lambda bytes_: bytes_[:12] + struct.pack("<I", 1) + bytes_[16:], "friction law"),
        (lambda bytes_: bytes_ + b"a", " bytes, and these are "),
        (lambda bytes_: bytes_[:24] + struct.pack("<d", math.nan) + bytes_[32:], "structure"),
        (lambda bytes_: bytes_[:24] + struct.pack("<d", -1.0) + bytes_[32:], "m = -1.0 kg is out"),
        (lambda bytes_: bytes_[:-9] + b"\2" + bytes_[-8:], "no block reaches"),
        (lambda bytes_: bytes_[:24] + struct.pack("<d", 5.0) + bytes_[32:], "no block reaches"),
    ],
)
def test_a_refused_state_is_explained(
    library: Library, change: Callable[[bytes], bytes], said: str
) -> None:
    """The log says what is wrong with bytes whose checksum fits."""
    instance = _started(library)
    content = library.packed(instance)
    library.told.clear()
    changed = change(content)
    if len(changed) == len(content):
        changed = _checked(changed)
    status, _ = library.unpacked(instance, changed)
    assert status == ERROR
    assert said in library.told[-1][3]


def test_settings_that_hold_are_checked_as_those_that_are_wanted(library: Library) -> None:
    """A mass below zero among them is told with its value."""
    instance, at = _started(library), _holding(library)
    content = library.packed(instance)
    changed = content[:at] + struct.pack("<d", -1.0) + content[at + 8 :]
    assert library.unpacked(instance, _checked(changed))[0] == ERROR
    assert library.told[-1][3].startswith("m = -1.0 kg is out")


def _damaged(content: bytes, random_: random.Random) -> bytes:
    """Return bytes with other fields and a checksum that fits."""
    damaged = bytearray(content)
    for _ in range(random_.choice((1, 1, 1, 2, 4))):
        at = random_.randrange(_FIELDS, len(content) - 8)
        kind = random_.randrange(4)
        if kind == 0:
            damaged[at] = random_.choice((0, 1, 2, 3, 127, 128, 255))
        elif kind == 1:
            whole = random_.choice((-2, -1, 0, 1, 2, 4, 2**31 - 1, -(2**31)))
            damaged[at : at + 4] = struct.pack("<i", whole)
        else:
            # Fields of 8 bytes lie 0, 4, 5 and 6 bytes off multiples of 8.
            at = _FIELDS + 8 * random_.randrange((len(content) - _FIELDS - 8) // 8)
            at += random_.choice((0, 0, 4, 5, 1, 6, 2))
            size = 10.0 ** random_.choice((-300, -20, -3, 0, 3, 20, 300))
            value = random_.choice((-1.0, 0.0, 1.0, random_.uniform(-1.0, 1.0))) * size
            if kind == 3:
                value = random_.choice((math.nan, math.inf, -math.inf, 5e-324, -0.0, 1.8e308))
            damaged[at : at + 8] = struct.pack("<d", value)
    return _checked(bytes(damaged[: len(content)]))


def _contents(library: Library) -> Iterator[bytes]:
    """Give states in all phases and modes."""
    fresh = library.instantiate()
    yield library.packed(fresh)
    yield from (library.packed(_started(library, steps)) for steps in (0, 1, 3, 17, 40))
    yield library.packed(_started(library, 5, c=0.0, v=0.05))
    ended = _started(library, 9)
    library.call("Terminate", ended)
    yield library.packed(ended)


def test_changed_bytes_are_refused_or_hold_a_state_that_runs(
    library: Library, sized: Callable[[int], int]
) -> None:
    """Where the checksum was made to fit, no value is trusted: what is taken runs on, or says no.

    A state that is taken comes back with the same bytes.
    """
    random_ = random.Random(library.face)
    contents = list(_contents(library))
    instance = library.instantiate()
    taken = 0
    for _ in range(sized(DAMAGED)):
        damaged = _damaged(random_.choice(contents), random_)
        status, state = library.unpacked(instance, damaged)
        if status == OK:
            taken += 1
            assert library.put(instance, state) == OK
            assert library.packed(instance) == damaged
            for number in range(3):
                status, values = library.get(instance)
                if status == OK:
                    assert all(map(math.isfinite, values)), damaged.hex()
                library.set(instance, {"v": 0.01 * number})
                library.step(instance, 0.1 * number, random_.choice((1e-3, 0.1, 2.0)))
            assert library.free(instance, state) == OK
        assert library.call("Reset", instance) == OK
    # Most fields may have other values, so the test meets what is taken as well.
    assert 0.2 < taken / sized(DAMAGED) < 0.8


def test_a_get_into_a_state_overwrites_it(library: Library) -> None:
    """As FMI says: no second state is made where there is one."""
    instance = _started(library)
    _, state = library.take(instance)
    address = state.value
    expected = library.get(instance)
    assert library.step(instance, 5.0, 0.3) == OK
    later = library.get(instance)
    assert later != expected
    status, _ = library.take(instance, into=state)
    assert (status, state.value) == (OK, address)
    assert library.step(instance, 5.3, 0.3) == OK
    assert library.put(instance, state) == OK
    assert library.get(instance) == later


def test_a_state_outlives_its_instance(library: Library) -> None:
    """A state is set on another instance after its own was freed, and freed there."""
    instance = _started(library)
    expected = library.get(instance)
    _, state = library.take(instance)
    getattr(library.calls, f"fmi{library.face}FreeInstance")(instance)
    other = library.instantiate()
    assert library.put(other, state) == OK
    assert library.get(other) == expected
    assert (library.free(other, state), state.value) == (OK, None)
    assert library.free(other, state) == OK


def test_a_freed_state_is_seen(library: Library) -> None:
    """A second free does nothing; a freed state is neither set nor written out."""
    instance = _started(library)
    _, state = library.take(instance)
    kept = ctypes.c_void_p(state.value)
    again = ctypes.c_void_p(state.value)
    assert library.free(instance, state) == OK
    # States of other instances and a few frees later it is still known.
    for _ in range(31):
        _, more = library.take(instance, into=ctypes.c_void_p())
        assert more.value != kept.value
        assert library.free(instance, more) == OK
    assert (library.free(instance, again), again.value) == (OK, None)
    assert library.put(instance, kept) == ERROR
    assert library.told[-1][3] == "the state to set is none that this FMU handed out"
    assert library.call("Reset", instance) == OK
    size = ctypes.c_size_t()
    name = f"SerializedFMU{'state' if library.face == 2 else 'State'}Size"
    assert library.call(name, instance, kept, ctypes.byref(size)) == ERROR
    assert library.call("Reset", instance) == OK
    # A get into it makes another state.
    status, _ = library.take(instance, into=again)
    assert (status, library.put(instance, again)) == (OK, OK)


def test_a_state_of_another_fmu_is_refused(native: Native, tmp_path: Path) -> None:
    """The handle of an FMU with another identity is none of this one."""
    two, three = (Library(native(face), tmp_path / str(face)) for face in (2, 3))
    first, second = two.instantiate(), three.instantiate()
    _, state = two.take(first)
    assert three.put(second, state) == ERROR
    assert three.call("Reset", second) == OK
    assert three.free(second, state) == ERROR
    assert two.free(first, state) == OK


def test_a_step_to_the_end_of_numbers_leaves_a_state(native: Native, tmp_path: Path) -> None:
    """Where the time leaves the numbers, the state can still be written and read back."""
    library = Library(native(2), tmp_path)
    instance = library.instantiate()
    assert library.start(instance, 0.0, v=0.0) == OK
    assert library.step(instance, 1.5e308, 1e308) == OK
    assert library.unpacked(instance, library.packed(instance))[0] == OK


def test_the_count_of_slips_stays_at_the_largest_integer(library: Library) -> None:
    """A block that has slipped 2^31 - 1 times slips on, and the count stays where it is."""
    instance = _started(library)
    content = library.packed(instance)
    count = {2: "Integer", 3: "Int32"}[library.face]
    read = library.lists("Get", count, instance, [REFERENCE["n_slips"]], [0])
    assert read == (OK, list(struct.unpack_from("<i", content, _slips(library))))
    assert read[1][0] > 2
    at = _slips(library)
    full = content[:at] + struct.pack("<i", 2**31 - 1) + content[at + 4 :]
    status, state = library.unpacked(instance, _checked(full))
    assert (status, library.put(instance, state)) == (OK, OK)
    assert library.step(instance, 4.0, 5.0) == OK
    full_still = library.lists("Get", count, instance, [REFERENCE["n_slips"]], [0])
    assert full_still == (OK, [2**31 - 1])
