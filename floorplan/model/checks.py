"""Shape and type checks that the values of `floorplan.model` run once, at construction."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

Array = NDArray[Any]


def frozen_array(value: Any, dtype: DTypeLike, shape: tuple[int | str, ...], name: str, sizes: dict[str, int]) -> Array:
    """`value` as a read-only array of `dtype` and `shape`; a letter in `shape` must mean one size everywhere.

    `sizes` collects the sizes of the letters seen so far in one value. Raises ValueError (a bug, not a
    user's mistake) when the shape does not fit.
    """
    array = np.asarray(value, dtype=dtype)
    if array.flags.writeable:
        array = array.view()
        array.flags.writeable = False
    if array.ndim != len(shape):
        raise ValueError(f"{name} has shape {array.shape}, expected {shape}")
    for size, want in zip(array.shape, shape, strict=True):
        known = sizes.setdefault(want, size) if isinstance(want, str) else want
        if size != known:
            raise ValueError(f"{name} has shape {array.shape}, expected {shape} with {sizes}")
    return array


def freeze(instance: Any, layout: Mapping[str, tuple[DTypeLike, tuple[int | str, ...]]]) -> dict[str, int]:
    """Replace the named fields of a frozen dataclass by checked read-only arrays; gives back the sizes of the letters.

    A field that is None (an optional array) is left alone.
    """
    sizes: dict[str, int] = {}
    for name, (dtype, shape) in layout.items():
        value = getattr(instance, name)
        if value is not None:
            where = f"{type(instance).__name__}.{name}"
            object.__setattr__(instance, name, frozen_array(value, dtype, shape, where, sizes))
    return sizes
