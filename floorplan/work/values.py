"""Frozen dataclasses to JSON and arrays and back, exactly: whatever the model holds, without a line per type.

Arrays go to an `.npz` under the dotted path of their field; everything else goes to a JSON tree, in which
`{"array": path}` stands for an array and `{"float": "nan"}` for a number JSON has no word for.
"""

import dataclasses
import json
import math
import os
import types
import typing
from enum import Enum
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from floorplan.model.checks import Array
from floorplan.work.npz import read_npz, write_npz

T = TypeVar("T")


def save_value(folder: Path, value: object) -> None:
    """Write `value` as `value.json` and `value.npz` in `folder`."""
    arrays: dict[str, Array] = {}
    tree = encode(value, arrays)
    write_npz(folder / "value.npz", arrays)
    write_json(folder / "value.json", tree)


def load_value(folder: Path, kind: type[T]) -> T:
    """The value of type `kind` that `save_value` wrote in `folder`."""
    tree = json.loads((folder / "value.json").read_text("utf-8"))
    value = decode(kind, tree, read_npz(folder / "value.npz"))
    return typing.cast(T, value)


def write_json(path: Path, tree: object) -> None:
    """Write a JSON tree, one key a line, and flush it to disk."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        json.dump(tree, file, indent=1, ensure_ascii=False, allow_nan=False)
        file.write("\n")
        file.flush()
        os.fsync(file.fileno())


def encode(value: object, arrays: dict[str, Array], path: str = "value") -> Any:
    """`value` as a JSON tree; its arrays are added to `arrays` under their dotted path."""
    if isinstance(value, np.ndarray):
        arrays[path] = value
        return {"array": path}
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.generic):
        return encode(value.item(), arrays, path)
    if isinstance(value, float) and not math.isfinite(value):
        return {"float": repr(value)}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, tuple | list):
        return [encode(item, arrays, f"{path}.{i}") for i, item in enumerate(value)]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: encode(getattr(value, f.name), arrays, f"{path}.{f.name}") for f in dataclasses.fields(value)}
    raise TypeError(f"{path}: a {type(value).__name__} cannot be kept in a work folder")


def decode(kind: Any, tree: Any, arrays: dict[str, Array]) -> Any:
    """The value of type `kind` that `encode` made `tree` and `arrays` from."""
    if isinstance(tree, dict) and set(tree) == {"array"}:
        return arrays[tree["array"]]
    if isinstance(tree, dict) and set(tree) == {"float"}:
        return float(tree["float"])
    origin = typing.get_origin(kind)
    if origin in (typing.Union, types.UnionType):
        return _decode_union(kind, tree, arrays)
    if origin in (tuple, list):
        return _decode_sequence(kind, tree, arrays)
    if dataclasses.is_dataclass(kind) and isinstance(kind, type):
        hints = _hints(kind)
        return kind(**{name: decode(hints[name], item, arrays) for name, item in tree.items()})
    if isinstance(kind, type) and issubclass(kind, Enum | Path):
        return kind(tree)
    return float(tree) if kind is float else tree


def _decode_union(kind: Any, tree: Any, arrays: dict[str, Array]) -> Any:
    if tree is None:
        return None
    choices = [choice for choice in typing.get_args(kind) if choice is not type(None)]
    if len(choices) != 1:
        raise TypeError(f"{kind}: only 'X | None' can be read back")
    return decode(choices[0], tree, arrays)


def _decode_sequence(kind: Any, tree: list[Any], arrays: dict[str, Array]) -> Any:
    arguments = typing.get_args(kind)
    one_kind = typing.get_origin(kind) is list or (len(arguments) == 2 and arguments[1] is Ellipsis)
    kinds = [arguments[0]] * len(tree) if one_kind else list(arguments)
    items = [decode(item_kind, item, arrays) for item_kind, item in zip(kinds, tree, strict=True)]
    return items if typing.get_origin(kind) is list else tuple(items)


@cache
def _hints(kind: type) -> dict[str, Any]:
    return typing.get_type_hints(kind)
