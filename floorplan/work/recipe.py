"""Recipes and their keys: what a stage's result was made with, and what is different now."""

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any

from floorplan.work.code import code_fingerprint
from floorplan.work.stages import REPORTED_ONLY, Stage
from floorplan.work.values import encode


@dataclass(frozen=True)
class Recipe:
    """Everything a stage's result depends on; two equal recipes give the same bytes.

    `code` is the fingerprint of the stage's sources; `config` holds the stage's sections as JSON trees;
    `inputs` the keys of the stages it reads; `scan` the fingerprint of the recording, for `1-ingest` alone.
    """

    stage: str
    version: int
    code: str
    config: Mapping[str, Mapping[str, Any]]
    inputs: Mapping[str, str]
    scan: str = ""

    @property
    def key(self) -> str:
        """SHA-256 of the recipe, in hexadecimal."""
        return hashlib.sha256(json.dumps(self.as_json(), sort_keys=True).encode()).hexdigest()

    def as_json(self) -> dict[str, Any]:
        """The recipe as a JSON tree."""
        return {f.name: getattr(self, f.name) for f in fields(self)}


def recipe_of(stage: Stage, config: object, keys: Mapping[str, str], scan: str = "") -> Recipe:
    """The recipe of `stage` under `config`, whose attributes are the sections; `keys` of the stages made so far."""
    sections = {name: _section(name, getattr(config, name)) for name in stage.sections}
    inputs = {name: keys[name] for name in stage.inputs}
    return Recipe(stage.folder, stage.version, code_fingerprint(stage), sections, inputs, scan if not stage.inputs else "")


def _section(section: str, values: object) -> dict[str, Any]:
    tree: dict[str, Any] = encode(values, {})
    return {name: value for name, value in tree.items() if f"{section}.{name}" not in REPORTED_ONLY}


def differences(made: Mapping[str, Any], now: Recipe) -> tuple[str, ...]:
    """What differs between the recipe a result was `made` with (a JSON tree) and the one wanted `now`, in words."""
    found = list(_config_differences(made["config"], now.config))
    if made["version"] != now.version:
        found.append(f"made by version {made['version']} of the stage, now {now.version}")
    if made.get("code") != now.code:
        found.append("the program's code for this stage is another one now")
    if made["scan"] != now.scan:
        found.append("the scan's files changed")
    found += [f"{name} was made again" for name, key in now.inputs.items() if made["inputs"].get(name) != key]
    return tuple(found)


def _config_differences(made: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    for section in sorted({*made, *now}):
        old, new = made.get(section, {}), now.get(section, {})
        for name in sorted({*old, *new}):
            if name not in old:
                yield f"{section}.{name} is new"
            elif name not in new:
                yield f"{section}.{name} is gone"
            elif old[name] != new[name]:
                yield f"{section}.{name} was {old[name]}, now {new[name]}"
