"""Numbers in the native FMU's messages read back as they were."""

import ctypes
import math
import random
import struct
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from stickslip_native.named import HOME
from tests.conftest import Sized
from tests.native.compiling import FLAGS, run, written
from tests.native.core import sources
from tests.needs import needs

COUNT = 300_000
"""Number of random numbers at full size."""

COMMA = Path(__file__).with_name("comma.c")


def number_text(folder: Path, comma: bool) -> Callable[[float], str]:
    text = {file.name: file.read_bytes() for file in HOME.glob("face/text.[ch]")}
    written(sources("coulomb") | text | {COMMA.name: COMMA.read_bytes()}, folder)
    renamed = ["-Dsnprintf=comma_snprintf", "-Dstrtod=comma_strtod"] if comma else []
    run("cc", *FLAGS, *renamed, "-c", folder / "text.c", "-o", folder / "text.o")
    symbols = run("nm", folder / "text.o")
    assert [f"U comma_{name}" in symbols for name in ("snprintf", "strtod")] == [comma, comma]
    others = [each for each in folder.glob("*.c") if each.name != "text.c"]
    run("cc", *FLAGS, "-shared", folder / "text.o", *others, "-o", folder / "text.so", "-lm")
    function = ctypes.CDLL(str(folder / "text.so")).number_text
    function.argtypes = [ctypes.c_double, ctypes.c_char_p]
    function.restype = None
    buffer = ctypes.create_string_buffer(64)

    def text_of(value: float) -> str:
        function(value, buffer)
        return buffer.value.decode()

    return text_of


def hard() -> Iterator[float]:
    yield from (0.0, -0.0, 5e-324, 2.2250738585072014e-308, 1.7976931348623157e308, 1e23, 4.35)
    for power in [math.ldexp(1.0, power) for power in range(-1074, 1024)]:
        yield from (math.nextafter(power, -math.inf), power, -math.nextafter(power, math.inf))


def at_random(count: int) -> Iterator[float]:
    """Yield numbers with all bits at random, and with few digits."""
    chance = random.Random(14)
    for _ in range(count):
        kind = chance.random()
        if kind < 0.6:
            yield struct.unpack("<d", chance.randbytes(8))[0]
        elif kind < 0.7:
            yield struct.unpack("<d", struct.pack("<Q", chance.getrandbits(52)))[0]
        elif kind < 0.8:
            yield chance.uniform(-1e3, 1e3)
        else:
            digits = chance.randint(1, 10 ** chance.randint(1, 17))
            yield float(f"{digits}e{chance.randint(-30, 30)}")


@needs("cc")
@pytest.mark.parametrize("comma", [False, True], ids=["point", "comma in the locale"])
def test_a_number_reads_back_in_few_digits(comma: bool, tmp_path: Path, sized: Sized) -> None:
    text = number_text(tmp_path, comma)
    numbers = [*hard(), *at_random(sized(COUNT) if not comma else 5_000)]
    wrong = [(each, text(each)) for each in numbers if repr(float(text(each))) != repr(each)]
    assert not wrong, (len(wrong), wrong[:5])
    assert not [each for each in numbers if len(text(each)) > 24]
    known = {0.1: "0.1", 1.0: "1.0", -2e-5: "-2e-05", math.inf: "inf", -math.inf: "-inf"}
    assert {each: text(each) for each in known} == known
    assert text(math.copysign(math.nan, -1.0)) == "nan"
