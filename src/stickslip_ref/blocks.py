"""Formulas on whole fields of parameters, a block of points at a time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from .parameters import FloatOrArray

_BLOCK = 16384
"""Points evaluated at a time: the dozen arrays in use (8 B each) stay in the second-level cache."""

_KEPT = 2**20
"""Freeing so many doubles at once, 8 MB, has glibc keep what the blocks free, for the next one: its
thresholds rise to what is freed (mallopt(3)). It gave pages back and faulted them in again, which
doubled the time of a block."""


def evaluate(
    kernel: Callable[..., None],
    operands: tuple[FloatOrArray, ...],
    shape: tuple[int, ...],
    dtypes: list[type[np.generic]],
) -> list[Any]:
    """Evaluate the kernel in cache-sized blocks of the broadcast operands; numbers stay numbers.

    Parameters
    ----------
    kernel : callable
        Takes the list of a block's outputs, to be filled in, and the operands' values there: floats
        for numbers, arrays of the outputs' length for arrays. Each point's result must follow from
        its own values alone, so that blocks leave no trace.
    operands : tuple of float or array
        They broadcast to ``shape``.
    shape : tuple of int
        Shape of each result; ``()`` gives plain numbers.
    dtypes : list of type
        One for each result.
    """
    size = math.prod(shape)
    outputs = [np.empty(size, dtype) for dtype in dtypes]
    if size > _BLOCK:
        np.empty(_KEPT)
    with np.errstate(all="ignore"):
        for block, values in _blocks(operands, shape, size):
            kernel([output[block] for output in outputs], *values)
    if not shape:
        return [output.item() for output in outputs]
    return [output.reshape(shape) for output in outputs]


def _blocks(
    operands: tuple[FloatOrArray, ...], shape: tuple[int, ...], size: int
) -> Iterator[tuple[slice, list[Any]]]:
    flat: list[Any] = []
    for operand in operands:
        array = np.asarray(operand)
        if array.size == 1:
            flat.append(float(array.flat[0]))
        elif array.shape == shape and array.flags.c_contiguous:
            flat.append(array.reshape(-1))
        else:
            # The flat iterator of the broadcast view copies a block at a time, never the whole.
            flat.append(np.broadcast_to(array, shape).flat)
    for start in range(0, size, _BLOCK):
        block = slice(start, min(start + _BLOCK, size))
        yield block, [each if isinstance(each, float) else each[block] for each in flat]
