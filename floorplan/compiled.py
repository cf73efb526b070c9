"""The one door to numba: compiled on first call, cached on disk, without the interpreter lock."""

from collections.abc import Callable
from typing import ParamSpec, TypeVar

import numba  # type: ignore[import-untyped]

P = ParamSpec("P")
T = TypeVar("T")


def compiled(function: Callable[P, T]) -> Callable[P, T]:
    """`function` as machine code; nothing is compiled before its first call."""
    machine_code: Callable[P, T] = numba.njit(function, nogil=True, cache=True)
    return machine_code
