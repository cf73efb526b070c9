"""The fingerprint of a stage's own code: a result made by other code is stale, whoever changed it, an update or an editor.

The source files are followed by their import lines from the stage's entry modules. Left out is what no result depends on: the work
folder itself, messages, and the settings, whose values are in the key already.
"""

import hashlib
import os
import re
from functools import cache
from pathlib import Path

from floorplan.work.stages import Stage

PACKAGE = Path(__file__).resolve().parents[1]
LEFT_OUT = ("work", "config", "config_file", "reporting", "errors")
_IMPORT = re.compile(rb"^\s*from floorplan([.\w]*) import (\([^)]*\)|[^\n]*)", re.MULTILINE)  # this package has no other form


def code_fingerprint(stage: Stage) -> str:
    """SHA-256, shortened, over the sources that `stage` is made by."""
    digest = hashlib.sha256()
    for path in stage_sources(stage):
        digest.update(path.relative_to(PACKAGE).as_posix().encode() + b"\0" + _source(path) + b"\0")
    return digest.hexdigest()[:16]


def stage_sources(stage: Stage) -> tuple[Path, ...]:
    """The source files that `stage` is made by, sorted: its entry modules and all they import from this package."""
    found: set[Path] = set()
    waiting = [path for name in stage.modules for path in _files_of(tuple(name.split(".")))]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting.extend(_imported(path))
    return tuple(sorted(found))


@cache
def _source(path: Path) -> bytes:
    return path.read_bytes()


@cache
def _imported(path: Path) -> tuple[Path, ...]:
    found: list[Path] = []
    for package, names in _IMPORT.findall(_source(path)):
        parts = tuple(package.decode().split(".")[1:])
        for name in re.findall(rb"\w+", names):
            found += _files_of((*parts, name.decode()))
    return tuple(found)


def _files_of(parts: tuple[str, ...]) -> list[Path]:
    """The sources that `parts`, a module below this package or a name in one, is found in: packages and module."""
    if parts[0] in LEFT_OUT:
        return []
    known = _sources_in(PACKAGE)
    ways = [parts[:n] for n in range(1, len(parts) + 1)]
    names = [f"{'/'.join(way)}/__init__.py" for way in ways] + [f"{'/'.join(way)}.py" for way in ways]
    return [known[name] for name in names if name in known]


@cache
def _sources_in(package: Path) -> dict[str, Path]:
    """All source files by their place below `package`: asking the disk for each possible one costs a start a quarter of a second."""
    return {
        f"{Path(folder).relative_to(package).as_posix()}/{name}".removeprefix("./"): Path(folder, name)
        for folder, _, names in os.walk(package)
        for name in names
        if name.endswith(".py")
    }
