"""`plan.json`: the plan as JSON with a schema version, and back again without loss."""

import dataclasses
import json
import types
import typing
from enum import StrEnum
from typing import Any

import numpy as np

from floorplan.errors import InputError
from floorplan.model.plan import Plan

SCHEMA_VERSION = 1


def plan_to_json(plan: Plan) -> str:
    """The plan as text; numbers are written so that they read back exactly. Raises ValueError on NaN (a bug)."""
    document = {"schema_version": SCHEMA_VERSION, "units": "m", **_encoded(plan)}
    return "{\n" + ",\n".join(f" {_text(name)}: {_rows(value)}" for name, value in document.items()) + "\n}\n"


def _rows(value: Any) -> str:
    """A list one item a line, to be read and compared; no deeper, because the fast encoder writes one line at a time."""
    if not isinstance(value, list) or not value:
        return _text(value)
    whole = _text(value)
    plain = whole.startswith("[[") and whole.count("[") == len(value) + 1  # a table of numbers, of ten thousand rows maybe
    return "[\n  " + (whole[1:-1].replace("], [", "],\n  [") if plain else ",\n  ".join(map(_text, value))) + "\n ]"


_text = json.JSONEncoder(allow_nan=False, ensure_ascii=False).encode


def plan_from_json(text: str) -> Plan:
    """The plan of a `plan.json`. Raises InputError when it is not one, or of another schema version."""
    try:
        document = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(f"plan.json is not JSON ({error}); build the plan again") from error
    version = document.get("schema_version") if isinstance(document, dict) else None
    if version != SCHEMA_VERSION:
        raise InputError(f"plan.json has schema version {version}, this program reads {SCHEMA_VERSION}; build the plan again")
    plan: Plan = _decoded_dataclass(Plan, document)
    return plan


def _encoded(value: Any) -> Any:
    if dataclasses.is_dataclass(value):
        return {field.name: _encoded(getattr(value, field.name)) for field in dataclasses.fields(value)}
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, StrEnum):
        return value.value
    if isinstance(value, tuple | list):
        return [_encoded(item) for item in value]
    return value


def _decoded_dataclass(kind: Any, document: dict[str, Any]) -> Any:
    hints = typing.get_type_hints(kind)
    known = [field.name for field in dataclasses.fields(kind) if field.name in document]
    return kind(**{name: _decoded(hints[name], document[name]) for name in known})


def _decoded(kind: Any, value: Any) -> Any:
    origin = typing.get_origin(kind)
    if origin in (types.UnionType, typing.Union):
        return None if value is None else _decoded(next(k for k in typing.get_args(kind) if k is not types.NoneType), value)
    if origin is tuple:
        kinds = typing.get_args(kind)
        if kinds[-1] is Ellipsis:
            return tuple(_decoded(kinds[0], item) for item in value)
        return tuple(_decoded(k, item) for k, item in zip(kinds, value, strict=True))
    if origin is np.ndarray:
        return _decoded_array(value)
    if dataclasses.is_dataclass(kind):
        return _decoded_dataclass(kind, value)
    if kind is float:
        return float(value)
    return kind(value) if isinstance(kind, type) and issubclass(kind, StrEnum) else value


def _decoded_array(value: Any) -> Any:
    array = np.array(value)
    return array if array.size else np.zeros((0, 2))
