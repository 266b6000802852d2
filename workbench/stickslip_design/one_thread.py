"""Small matrices on one thread of BLAS: several wait for each other, at ten times the cost."""

from collections.abc import Callable
from typing import TypeVar, cast

from threadpoolctl import threadpool_limits

_Function = TypeVar("_Function", bound=Callable[..., object])


def one_thread(function: _Function) -> _Function:
    """Return the function, run with one thread of BLAS; the caller's number comes back after it."""
    return cast("_Function", threadpool_limits.wrap(limits=1, user_api="blas")(function))
