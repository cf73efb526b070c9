"""JSON files of recordings: numbers by name, and a clear word where they are not there."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from floorplan.errors import InputError


def read_json(path: Path) -> dict[str, Any]:
    """The object in a JSON file. Raises `InputError` when there is none."""
    try:
        return text_object(path.read_bytes(), path)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error}); copy the recording again") from error


def text_object(text: bytes, where: Path) -> dict[str, Any]:
    """The JSON object in a text. Raises `InputError` when there is none."""
    try:
        return as_object(json.loads(text.decode("utf-8-sig")), where)
    except ValueError as error:
        raise InputError(f"{where}: cannot be read ({error}); copy the recording again") from error


def as_object(value: Any, where: Path) -> dict[str, Any]:
    """`value` where it is a JSON object; else raises `InputError`."""
    if not isinstance(value, dict):
        raise InputError(f"{where}: not a JSON object; copy the recording again")
    return value


def numbers(tree: dict[str, Any], names: Sequence[str], where: Path) -> list[float]:
    """The numbers called `names`. Raises `InputError` for one that is missing or none."""
    try:
        return [float(tree[name]) for name in names]
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"{where}: {error} is missing or no number; export the recording again") from error


def number_list(tree: dict[str, Any], name: str, count: int, where: Path) -> list[float]:
    """The list of `count` numbers called `name`. Raises `InputError` for anything else."""
    values = tree.get(name)
    if not isinstance(values, list) or len(values) != count or not all(isinstance(value, int | float) for value in values):
        raise InputError(f"{where}: {name} is no list of {count} numbers; export the recording again")
    return [float(value) for value in values]
