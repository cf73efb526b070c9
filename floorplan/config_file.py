"""The configuration from a TOML file and `--set section.key=value`, checked; and back to TOML."""

import dataclasses
import difflib
import inspect
import math
import re
import tomllib
import types
import typing
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from floorplan.config import Config
from floorplan.errors import ConfigError

_MAGNITUDE_SUFFIXES = ("_m", "_m2", "_s", "_deg", "_rad", "_px", "_pixels", "_frames", "_stride")  # a size: never negative


def load_config(path: Path | None = None, settings: Iterable[str] = ()) -> Config:
    """The defaults, changed by the TOML file at `path`, then by `settings` such as `merge.radius_m=0.5`.

    Raises `ConfigError` for an unknown section or key, a wrong type, a value out of range.
    """
    config = Config()
    if path is not None:
        config = _with_tables(config, _read_toml(path), str(path))
    for setting in settings:
        config = _with_setting(config, setting)
    return config


def config_to_toml(config: Config, comments: bool = False) -> str:
    """The whole effective configuration as TOML; what is unset (None) stands as a comment. `comments`: the reason of each setting."""
    lines: list[str] = []
    for section in dataclasses.fields(config):
        values = getattr(config, section.name)
        reasons = setting_comments(type(values)) if comments else {}
        lines += [f"# {sentence}" for sentence in (type(values).__doc__ or "").split("\n")[:1] if comments]
        lines.append(f"[{section.name}]")
        for f in dataclasses.fields(values):
            reason = f"  # {reasons[f.name]}" if reasons.get(f.name) else ""
            lines.append(_toml_line(f.name, getattr(values, f.name)) + reason)
        lines.append("")
    return "\n".join(lines[:-1]) + "\n"


def setting_comments(section: type) -> dict[str, str]:
    """The comment of each field of a section, from the source of `config.py`: what stands before it and behind it."""
    found: dict[str, str] = {}
    before: list[str] = []
    for line in inspect.getsource(section).splitlines():
        code, _, comment = line.partition("  # ")
        if line.strip().startswith("# "):
            before.append(line.strip()[2:])
            continue
        if match := re.match(r" {4}(\w+): ", code):
            found[match[1]] = " ".join([*before, comment.strip()]).strip()
        before = []
    return found


def _read_toml(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise ConfigError(f"{path}: no such configuration file")
    try:
        return tomllib.loads(path.read_text("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path} is not valid TOML: {error}") from error


def _with_tables(config: Config, tables: Mapping[str, Any], where: str) -> Config:
    for section, values in tables.items():
        if not isinstance(values, Mapping):
            raise ConfigError(f"{where}: '{section}' stands outside a section; write it under [section]")
        for name, value in values.items():
            config = _with_value(config, section, name, value, where)
    return config


def _with_setting(config: Config, setting: str) -> Config:
    match = re.fullmatch(r"\s*(\w+)\.(\w+)\s*=(.*)", setting, re.DOTALL)
    if match is None:
        raise ConfigError(f"--set {setting}: expected section.key=value, such as merge.radius_m=0.5")
    section, name, text = match.groups()
    return _with_value(config, section, name, _parsed(text.strip()), f"--set {setting}")


def _parsed(text: str) -> Any:
    """A TOML value, or the text itself where it is none (so that words need no quotes)."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _with_value(config: Config, section: str, name: str, value: Any, where: str) -> Config:
    sections = [f.name for f in dataclasses.fields(config)]
    if section not in sections:
        raise ConfigError(f"{where}: no section '{section}'{_suggestion(section, sections)}")
    values = getattr(config, section)
    names = [f.name for f in dataclasses.fields(values)]
    if name not in names:
        elsewhere = [f"{s}.{name}" for s in sections if name in {f.name for f in dataclasses.fields(getattr(config, s))}]
        hint = f"; did you mean {elsewhere[0]}?" if elsewhere else _suggestion(name, names)
        raise ConfigError(f"{where}: no setting '{name}' in section '{section}'{hint}")
    kind = typing.get_type_hints(type(values))[name]
    checked = _checked(kind, name, value, f"{where}: {section}.{name}")
    return dataclasses.replace(config, **{section: dataclasses.replace(values, **{name: checked})})


def _suggestion(word: str, known: list[str]) -> str:
    near = difflib.get_close_matches(word, known, 1, 0.5)
    return f"; did you mean '{near[0]}'?" if near else f"; there are {', '.join(known)}"


def _checked(kind: Any, name: str, value: Any, where: str) -> Any:
    origin, choices = typing.get_origin(kind), typing.get_args(kind)
    if origin in (typing.Union, types.UnionType):
        if value in ("none", "None", ""):
            return None
        return _checked(next(choice for choice in choices if choice is not type(None)), name, value, where)
    if origin is typing.Literal:
        if value not in choices:
            raise ConfigError(f"{where} is {value!r}; it can be {', '.join(map(str, choices))}")
        return value
    if origin is tuple:
        if not isinstance(value, list):
            raise ConfigError(f"{where} must be a list such as [1, 2], not {value!r}")
        kinds = [choices[0]] * len(value) if choices[-1] is Ellipsis else list(choices)
        if len(kinds) != len(value):
            raise ConfigError(f"{where} must have {len(kinds)} values, not {len(value)}")
        return tuple(_checked(k, name, v, where) for k, v in zip(kinds, value, strict=True))
    return _checked_scalar(kind, name, value, where)


def _checked_scalar(kind: Any, name: str, value: Any, where: str) -> Any:
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if kind is str and isinstance(value, int | float) and not isinstance(value, bool):
        value = str(value)  # --set project.floor=2 means the text
    if type(value) is not kind:
        raise ConfigError(f"{where} must be {_KIND_WORDS.get(kind, kind.__name__)}, not {value!r}")
    if kind is float and not math.isfinite(value):
        raise ConfigError(f"{where} must be a finite number, not {value}")
    if kind in (int, float) and value < 0 and name.endswith(_MAGNITUDE_SUFFIXES):
        raise ConfigError(f"{where} must not be negative, and is {value}")
    return value


_KIND_WORDS: dict[type, str] = {float: "a number", int: "a whole number", bool: "true or false", str: "text"}


def _toml_line(name: str, value: Any) -> str:
    return f"# {name} =" if value is None else f"{name} = {_toml_value(value)}"


def _toml_value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
        return f'"{escaped}"'
    if isinstance(value, tuple):
        return f"[{', '.join(_toml_value(item) for item in value)}]"
    return repr(value)
