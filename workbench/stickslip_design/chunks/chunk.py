"""Chunk files: the results of some points, with a digest that tells whether the file is whole.

A file has a first line with the SHA-256 of the rest; the rest is a line of JSON (the study's key,
the chunk, the names of the columns) and, for each column, an array in NumPy's format (.npy).
"""

from __future__ import annotations

import json
import re
from hashlib import sha256
from io import BytesIO
from typing import Final

import numpy as np
from numpy.lib import format as npy

from .study import Chunk, Columns, StudyError

_FIRST: Final = b"stickslip chunk 1 "
_LINE: Final = len(_FIRST) + 64
"""Bytes of the first line, without its end."""
_NAME: Final = re.compile(r"points-(\d{12})-(\d{12})\.chunk")


def name_of(chunk: Chunk) -> str:
    """Return the name of the file of a chunk."""
    return f"points-{chunk.start:012}-{chunk.stop:012}.chunk"


def chunk_of(name: str) -> Chunk | None:
    """Return the chunk that a file holds, by its name; None if it is no chunk file."""
    found = _NAME.fullmatch(name)
    return None if found is None else Chunk(int(found[1]), int(found[2]))


def packed(chunk: Chunk, key: str, columns: Columns) -> bytes:
    """Return the content of the file of a chunk.

    Raises
    ------
    StudyError
        If a column has not one number or text a point.
    """
    body = BytesIO()
    body.write(json.dumps({"study": key, "chunk": chunk, "columns": list(columns)}).encode())
    body.write(b"\n")
    for name, column in columns.items():
        values = np.asarray(column)
        if values.shape != (chunk.points,) or values.dtype.hasobject:
            raise StudyError(
                f"{chunk}: the column {name} has shape {values.shape} and type {values.dtype}; "
                f"{chunk.points} numbers or texts are due"
            )
        npy.write_array(body, values, allow_pickle=False)
    digest = sha256(body.getbuffer()).hexdigest().encode()
    return b"".join((_FIRST, digest, b"\n", body.getbuffer()))


def unpacked(content: bytes, chunk: Chunk, key: str) -> Columns | None:
    """Return the columns of a chunk file; None if it is not whole or of another study."""
    body = memoryview(content)[_LINE + 1 :]
    if content[: _LINE + 1] != _FIRST + sha256(body).hexdigest().encode() + b"\n":
        return None
    stream = BytesIO(body)
    header = json.loads(stream.readline())
    if (header["study"], tuple(header["chunk"])) != (key, chunk):
        return None
    return {name: npy.read_array(stream, allow_pickle=False) for name in header["columns"]}


def failures(columns: Columns) -> int:
    """Return how many points have no result."""
    return int(np.count_nonzero(columns["failure"])) if "failure" in columns else 0
