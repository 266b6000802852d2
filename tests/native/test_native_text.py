"""Numbers in the native FMU's messages are written as Python writes them."""

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
    """Yield numbers at which a way to the shortest text goes wrong."""
    yield from (0.0, -0.0, math.inf, -math.inf, math.nan)
    # Gaps change at powers of two, texts at powers of ten; the exponent begins at 1e16 and 1e-4.
    powers = [math.ldexp(1.0, power) for power in range(-1074, 1024)]
    powers += [float(f"1e{power}") for power in range(-323, 309)]
    for value in powers:
        for near in (math.nextafter(value, -math.inf), value, math.nextafter(value, math.inf)):
            yield from (near, -near)
    # Halfway between decimals of one digit less, and between doubles as texts.
    for power in range(49, 64):
        yield from (float(2**power + odd) for odd in range(1, 64, 2))
    yield from (whole + 0.5 for whole in range(2**49, 2**49 + 50))
    yield from (5e-324, 1.5e-323, 2.2250738585072009e-308, 1.7976931348623157e308)
    yield from (9007199254740993.0, 2.0**-44, 8.41e21, 2.2250738585072014e-308, 1e23, 4.35, 0.1)


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
def test_a_number_is_written_as_repr_writes_it(comma: bool, tmp_path: Path, sized: Sized) -> None:
    text = number_text(tmp_path, comma)
    numbers = [*hard(), *at_random(sized(COUNT) if not comma else 5_000)]
    wrong = [(repr(each), text(each)) for each in numbers if text(each) != repr(each)]
    assert not wrong, (len(wrong), wrong[:5])
