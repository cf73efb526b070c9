"""Libraries that only some formats need, asked for when they are needed."""

import importlib
from typing import Any

from floorplan.errors import InputError


def optional_library(module: str, package: str, need: str) -> Any:
    """The module; raises `InputError` that says how to get it where it is not installed."""
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        raise InputError(f"{need}; 'pip install {package}' adds what reads that") from error
