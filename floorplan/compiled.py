"""The one door to numba: compiled on first call, cached on disk, without the interpreter lock."""

import atexit
import os
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

import numba
from numba import njit as njit

P = ParamSpec("P")
T = TypeVar("T")


def _keep_machine_code() -> None:
    """Where neither the package nor the user's home can be written, machine code is kept for this run alone, not refused."""
    settings = cast(Any, numba.config)
    user_cache = Path.home() / ".cache"
    existing = next(path for path in (user_cache, *user_cache.parents) if path.exists())
    if not (settings.CACHE_DIR or os.access(Path(__file__).parent, os.W_OK) or os.access(existing, os.W_OK)):
        settings.CACHE_DIR = tempfile.mkdtemp(prefix="floorplan-")
        atexit.register(shutil.rmtree, settings.CACHE_DIR, ignore_errors=True)


_keep_machine_code()


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
