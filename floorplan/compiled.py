"""The one door to numba: compiled on first call, cached on disk, without the interpreter lock."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba

P = ParamSpec("P")
T = TypeVar("T")


def compiled(function: Callable[P, T]) -> Callable[P, T]:
    """`function` as machine code; nothing is compiled before its first call. A division by zero gives inf or NaN, as in numpy."""
    return cast(Callable[P, T], numba.njit(nogil=True, cache=True, error_model="numpy")(function))


def inlined(function: Callable[P, T]) -> Callable[P, T]:
    """A piece of a `compiled` loop's innermost body, put in its place before compilation: a call there would cost a third of the time."""
    return cast(Callable[P, T], numba.njit(nogil=True, inline="always", error_model="numpy")(function))


def on_disk(function: Callable[..., Any]) -> bool:
    """Whether machine code of a `compiled` function was kept by an earlier run."""
    kernel = cast(Any, function)
    return any(Path(kernel.stats.cache_path).glob(f"*.{kernel.py_func.__name__}-*.nbi"))
