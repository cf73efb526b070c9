"""The one door to numba: compiled on first call, cached on disk, without the interpreter lock."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar, cast

import numba

P = ParamSpec("P")
T = TypeVar("T")


def compiled(function: Callable[P, T]) -> Callable[P, T]:
    """`function` as machine code; nothing is compiled before its first call."""
    return cast(Callable[P, T], numba.njit(nogil=True, cache=True, error_model="numpy")(function))
