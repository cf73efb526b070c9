"""edits.toml to values. Every edit is a table of its own: `[[never_merge]]`, `[[always_merge]]`, `[[furniture]]`, ... (KEYS)."""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from floorplan.errors import ConfigError
from floorplan.model.plan import OpeningKind

KEYS = {
    "never_merge": ("tracks",),
    "always_merge": ("tracks",),
    "furniture": ("id",),
    "opening": ("id", "kind"),
    "room": ("id", "name"),
    "delete": ("id",),
}


@dataclass(frozen=True)
class TrackPair:
    """Two initial planes by the numbers that `floorplan merges` shows."""

    first: int
    second: int


@dataclass(frozen=True)
class OpeningKindEdit:
    """An opening is of another kind than it was taken for."""

    id: str
    kind: OpeningKind


@dataclass(frozen=True)
class RoomName:
    """What a room is called."""

    id: str
    name: str


@dataclass(frozen=True)
class Edits:
    """All edits of one file; `furniture` are ids of planes or walls, `delete` ids of walls or lines off the axes."""

    never_merge: tuple[TrackPair, ...] = ()
    always_merge: tuple[TrackPair, ...] = ()
    furniture: tuple[str, ...] = ()
    opening: tuple[OpeningKindEdit, ...] = ()
    room: tuple[RoomName, ...] = ()
    delete: tuple[str, ...] = ()


def read_edits(path: Path) -> Edits:
    """The edits of a file. Raises ConfigError that names the table and the key."""
    try:
        tree = tomllib.loads(path.read_text("utf-8-sig"))
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read ({error.strerror}); give the file with the edits") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path} is not valid TOML: {error}") from error
    for name, rows in tree.items():
        _check_table(path, name, rows)
    return Edits(
        never_merge=tuple(_pair(path, row) for row in tree.get("never_merge", [])),
        always_merge=tuple(_pair(path, row) for row in tree.get("always_merge", [])),
        furniture=tuple(_id(path, row) for row in tree.get("furniture", [])),
        opening=tuple(OpeningKindEdit(_id(path, row), _kind(path, row)) for row in tree.get("opening", [])),
        room=tuple(RoomName(_id(path, row), str(row["name"])) for row in tree.get("room", [])),
        delete=tuple(_id(path, row) for row in tree.get("delete", [])),
    )


def _check_table(path: Path, name: str, rows: Any) -> None:
    if name not in KEYS:
        raise ConfigError(f"{path}: there is no edit '{name}'; there are {', '.join(KEYS)}")
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise ConfigError(f"{path}: write each edit as a table of its own, [[{name}]]")
    for row in rows:
        if set(row) != set(KEYS[name]):
            raise ConfigError(f"{path}: [[{name}]] has {', '.join(row) or 'nothing'}; it takes {' and '.join(KEYS[name])}")


def _pair(path: Path, row: dict[str, Any]) -> TrackPair:
    tracks = row["tracks"]
    if not isinstance(tracks, list) or len(tracks) != 2 or not all(type(t) is int and t >= 0 for t in tracks) or tracks[0] == tracks[1]:
        raise ConfigError(f"{path}: tracks = {tracks!r}; give two different track numbers as 'floorplan merges' shows them, [3, 17]")
    return TrackPair(tracks[0], tracks[1])


def _id(path: Path, row: dict[str, Any]) -> str:
    if not isinstance(row["id"], str) or not row["id"]:
        raise ConfigError(f"{path}: id = {row['id']!r}; give an id of the plan in quotes, such as \"R2\"")
    return str(row["id"])


def _kind(path: Path, row: dict[str, Any]) -> OpeningKind:
    kinds = [kind.value for kind in OpeningKind]
    if row["kind"] not in kinds:
        raise ConfigError(f"{path}: kind = {row['kind']!r}; an opening is a {', '.join(kinds)}")
    return OpeningKind(row["kind"])
