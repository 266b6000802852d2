"""The libraries that a program for Linux names, read from its ELF file."""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Final

_IDENTITY: Final = b"\x7fELF\x02\x01"
"""The first bytes of an ELF file of 64 bits, little-endian."""

# Offset, size and number of the program headers stand here in the file header.
_PROGRAM_HEADERS: Final = struct.Struct("<32xQ14xHH")
# Type, offset in the file, address in memory, size in the file.
_SEGMENT: Final = struct.Struct("<I4xQQ8xQ")
_LOADED, _DYNAMIC = 1, 2
_ENTRY: Final = struct.Struct("<qQ")
_END, _NEEDED, _STRINGS = 0, 1, 5


def needed_libraries(program: Path) -> tuple[str, ...]:
    """Return the names of the shared libraries that a program is linked to, in its order.

    Those are the entries DT_NEEDED of its dynamic section, not what these libraries need in turn.
    Nothing where the file cannot be read, is static, damaged, or no ELF file of 64 bits: a script.

    Notes
    -----
    System V Application Binary Interface, chapters 4 (Object Files) and 5 (Program Loading).
    """
    try:
        return tuple(_names(program.read_bytes()))
    except (OSError, LookupError, ValueError, struct.error):
        return ()


def _names(image: bytes) -> Iterator[str]:
    if not image.startswith(_IDENTITY):
        return
    start, size, count = _PROGRAM_HEADERS.unpack_from(image)
    segments = [_SEGMENT.unpack_from(image, start + size * n) for n in range(count)]
    entries = [
        entry
        for kind, offset, _, length in segments
        if kind == _DYNAMIC
        for entry in _entries(image[offset : offset + length])
    ]
    for tag, value in entries:
        if tag == _NEEDED:
            first = _in_file(dict(entries)[_STRINGS], segments) + value
            yield image[first : image.index(b"\0", first)].decode()


def _entries(section: bytes) -> Iterator[tuple[int, int]]:
    for tag, value in _ENTRY.iter_unpack(section):
        if tag == _END:
            return
        yield tag, value


def _in_file(address: int, segments: list[tuple[int, int, int, int]]) -> int:
    """Return where in the file stands what is loaded to an address."""
    for kind, offset, begin, length in segments:
        if kind == _LOADED and begin <= address < begin + length:
            return offset + address - begin
    raise ValueError(f"nothing is loaded to {address:#x}")
