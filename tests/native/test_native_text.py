"""Numbers in the native FMU's messages are written as Python writes them."""

import ctypes
import math
import random
import struct
import subprocess
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import pytest

from stickslip_fmu.spec import SPEC
from stickslip_native.compiler import FLAGS
from stickslip_native.named import HOME, LAWS
from stickslip_native.table import table_files
from tests.needs import needs

Text = Callable[[float], str]

COUNT = 1_000_000

# A C library whose locale has a decimal comma, for text.c alone.
COMMA = r"""
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int comma_snprintf(char *text, size_t size, const char *format, ...)
{
    va_list arguments;
    char *point;
    va_start(arguments, format);
    const int length = vsnprintf(text, size, format, arguments);
    va_end(arguments);
    if (strcmp(format, "%.*e") == 0 && (point = strchr(text, '.')) != NULL) *point = ',';
    return length;
}

double comma_strtod(const char *text, char **end)
{
    char changed[100];
    char *mark;
    strcpy(changed, text);
    if ((mark = strchr(changed, '.')) != NULL) *mark = '\0';
    if ((mark = strchr(changed, ',')) != NULL) *mark = '.';
    return strtod(changed, end);
}
"""


def _compiled(folder: Path, comma: bool = False) -> Text:
    """Return number_text of the native FMU, compiled."""
    for name, content in table_files(SPEC).items():
        (folder / name).write_text(content)
    folders = (HOME / "core", LAWS / "coulomb", LAWS / "shared", folder)
    compile_: list[str | Path] = ["cc", *FLAGS, "-fvisibility=default"]
    compile_ += [f"-I{each}" for each in folders]
    renamed = ["-Dsnprintf=comma_snprintf", "-Dstrtod=comma_strtod"] if comma else []
    words = [*compile_, *renamed, "-c", HOME / "face" / "text.c", "-o", folder / "text.o"]
    subprocess.run(words, check=True)
    (folder / "law.c").write_text('#include "law.h"\nconst struct law LAW = {0};\n')
    sources = [folder / "text.o", folder / "table.c", folder / "law.c"]
    if comma:
        sources.append(folder / "comma.c")
        sources[-1].write_text(COMMA)
    library = folder / "text.so"
    subprocess.run([*compile_, "-shared", *sources, "-o", library, "-lm"], check=True)
    number_text = ctypes.CDLL(str(library)).number_text
    number_text.argtypes = [ctypes.c_double, ctypes.c_char_p]
    number_text.restype = None
    buffer = ctypes.create_string_buffer(64)

    def text(value: float) -> str:
        number_text(value, buffer)
        return buffer.value.decode()

    return text


def _neighbours(value: float) -> Iterator[float]:
    """Give a number and those beside it, of both signs."""
    for each in (math.nextafter(value, -math.inf), value, math.nextafter(value, math.inf)):
        yield from (each, -each)


def _hard() -> Iterator[float]:
    """Give numbers at which a way to the shortest text goes wrong."""
    yield from (0.0, -0.0, math.inf, -math.inf, math.nan)
    # Gaps change at powers of two, texts at powers of ten; the exponent begins at 1e16 and 1e-4.
    for power in range(-1074, 1024):
        yield from _neighbours(math.ldexp(1.0, power))
    for power in range(-323, 309):
        yield from _neighbours(float(f"1e{power}"))
    # Halfway between decimals of one digit less, and between doubles as texts.
    for power in range(49, 64):
        yield from (float(2**power + odd) for odd in range(1, 64, 2))
    yield from (whole + 0.5 for whole in range(2**49, 2**49 + 50))
    yield from (5e-324, 1.5e-323, 2.2250738585072009e-308, 1.7976931348623157e308)
    yield from (9007199254740993.0, 2.0**-44, 8.41e21, 2.2250738585072014e-308, 1e23, 4.35, 0.1)


def _random(count: int) -> Iterator[float]:
    """Give numbers with all bits at random, and with few digits."""
    random_ = random.Random(14)
    for _ in range(count):
        kind = random_.random()
        if kind < 0.6:
            yield struct.unpack("<d", random_.randbytes(8))[0]
        elif kind < 0.7:
            yield struct.unpack("<d", struct.pack("<Q", random_.getrandbits(52)))[0]
        elif kind < 0.8:
            yield random_.uniform(-1e3, 1e3)
        else:
            digits = random_.randint(1, 10 ** random_.randint(1, 17))
            yield float(f"{digits}e{random_.randint(-30, 30)}")


def _check(text: Text, numbers: Iterable[float]) -> None:
    wrong = [(repr(each), text(each)) for each in numbers if text(each) != repr(each)]
    assert not wrong, (len(wrong), wrong[:5])


@needs("cc")
def test_a_number_is_written_as_repr_writes_it(tmp_path: Path, sized: Callable[[int], int]) -> None:
    """The text is that of Python's repr, for a million numbers and for all that are hard."""
    text = _compiled(tmp_path)
    _check(text, _hard())
    _check(text, _random(sized(COUNT)))


@needs("cc")
def test_no_text_depends_on_the_decimal_point_of_the_locale(tmp_path: Path) -> None:
    """A C library whose locale has a decimal comma gives the same texts."""
    text = _compiled(tmp_path, comma=True)
    _check(text, _hard())
    _check(text, _random(5_000))


@needs("cc")
@pytest.mark.parametrize("symbol", ["snprintf", "strtod"])
def test_the_stub_of_the_locale_acts(tmp_path: Path, symbol: str) -> None:
    """The C library with a decimal comma is the one that text.c calls."""
    _compiled(tmp_path, comma=True)
    listed = subprocess.run(
        ["nm", tmp_path / "text.o"], capture_output=True, text=True, check=True
    ).stdout
    assert f"U comma_{symbol}" in listed
