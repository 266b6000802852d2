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

_FIRST: Final = b"stickslip chunk 1 %s\n"
_LINE: Final = len(_FIRST % bytes(64))
_NAME: Final = re.compile(r"points-(\d{12})-(\d{12})\.chunk")


def name_of(chunk: Chunk) -> str:
    """Return the name of the file of a chunk."""
    return f"points-{chunk.start:012}-{chunk.stop:012}.chunk"


def chunk_of(name: str) -> Chunk | None:
    """Return the chunk that a file holds, by its name; None if it is no chunk file."""
    match = _NAME.fullmatch(name)
    return None if match is None else Chunk(int(match[1]), int(match[2]))


def packed(chunk: Chunk, key: str, columns: Columns) -> bytes:
    """Return the content of the file of a chunk; a `StudyError` if a column does not fit."""
    body = BytesIO()
    body.write(json.dumps([key, chunk, list(columns)]).encode() + b"\n")
    for name, column in columns.items():
        values = np.asarray(column)
        if values.shape != (chunk.points,) or values.dtype.hasobject:
            raise StudyError(
                f"{chunk}: the column {name} has shape {values.shape} and type {values.dtype}; "
                f"{chunk.points} numbers or texts are due"
            )
        npy.write_array(body, values, allow_pickle=False)
    return _first_line(body.getbuffer()) + body.getbuffer()


def unpacked(content: bytes, chunk: Chunk, key: str) -> Columns | None:
    """Return the columns of a chunk file; None if it is not whole or of another study."""
    body = memoryview(content)[_LINE:]
    if content[:_LINE] != _first_line(body):
        return None
    stream = BytesIO(body)
    of, points, names = json.loads(stream.readline())
    if (of, tuple(points)) != (key, chunk):
        return None
    return {name: npy.read_array(stream, allow_pickle=False) for name in names}


def _first_line(body: memoryview) -> bytes:
    return _FIRST % sha256(body).hexdigest().encode()


def failures(columns: Columns) -> int:
    """Return how many points have no result."""
    return int(np.count_nonzero(columns["failure"])) if "failure" in columns else 0
