"""Small matrices on one thread of BLAS: several wait for each other, at ten times the cost."""

from collections.abc import Callable
from functools import cache, wraps
from threading import local
from typing import Any, TypeVar, cast

from threadpoolctl import ThreadpoolController

_Function = TypeVar("_Function", bound=Callable[..., object])
_state = local()


def one_thread(function: _Function) -> _Function:
    """Return the function, run with one thread of BLAS; the caller's number comes back after it."""

    @wraps(function)
    def limited(*values: Any, **named: Any) -> object:
        if getattr(_state, "limited", False):
            return function(*values, **named)
        _state.limited = True
        try:
            with _controller().limit(limits=1, user_api="blas"):
                return function(*values, **named)
        finally:
            _state.limited = False

    return cast("_Function", limited)


@cache
def _controller() -> ThreadpoolController:
    return ThreadpoolController()
