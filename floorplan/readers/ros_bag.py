"""ROS 1 and ROS 2 bags as a stream of messages: the one module that imports rosbags."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from floorplan.errors import InputError

BAG_SUFFIXES = (".bag", ".db3", ".mcap")
METADATA = "metadata.yaml"
REPAIR = {
    ".bag": "`rosbag reindex` rebuilds its index",
    ".mcap": "`mcap recover` writes what is there to a new file",
    ".db3": "`sqlite3 old.db3 .recover | sqlite3 new.db3` writes what is there to a new file",
}


@dataclass(frozen=True)
class Topic:
    """A topic of the bag: its message type without the package's middle part differs between ROS 1 and 2, so the ROS 2 name is used."""

    name: str
    type: str
    count: int


@dataclass(frozen=True)
class BagMessage:
    """One message: `log_ns` when it was written; `value` the decoded message, attributes as in its definition."""

    topic: str
    type: str
    log_ns: int
    value: Any


def bag_paths(path: Path) -> tuple[Path, ...]:
    """The bag at `path`: a file, a folder with metadata.yaml, or the bag files of a folder without; empty when there is none."""
    if path.is_file():
        return (path,) if path.suffix in BAG_SUFFIXES else ()
    if (path / METADATA).is_file():
        return (path,)
    return tuple(sorted(file for file in path.iterdir() if file.is_file() and file.suffix in BAG_SUFFIXES))


def topics_of(paths: tuple[Path, ...]) -> tuple[Topic, ...]:
    """Topics of a bag, by name. Raises `InputError` when the bag cannot be opened."""
    with _opened(paths) as reader:
        return tuple(Topic(name, info.msgtype or "", info.msgcount) for name, info in sorted(reader.topics.items()))


def messages(paths: tuple[Path, ...], topics: Collection[str], log_ns: Collection[int] = ()) -> Iterator[BagMessage]:
    """Messages of some topics in the order of writing, one in memory at a time; only those written at `log_ns`, unless empty.

    Raises `InputError` where the bag turns out to be damaged, after what could be read.
    """
    wanted = frozenset(log_ns)
    span = (min(wanted), max(wanted) + 1) if wanted else (None, None)
    with _opened(paths) as reader:
        connections = [c for c in reader.connections if c.topic in topics]
        if not connections:
            return
        for connection, written_ns, raw in reader.messages(connections, start=span[0], stop=span[1]):
            if not wanted or written_ns in wanted:
                yield BagMessage(connection.topic, connection.msgtype, written_ns, reader.deserialize(raw, connection.msgtype))


class _opened:  # noqa: N801 - a context manager, used like a function
    """An open reader; whatever rosbags says against the bag becomes an `InputError`."""

    def __init__(self, paths: tuple[Path, ...]) -> None:
        self.paths = paths

    def __enter__(self) -> Any:
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.typesys import Stores, get_typestore

        try:
            self.reader = AnyReader(self.paths, default_typestore=get_typestore(Stores.ROS2_HUMBLE))
            self.reader.open()
        except (AnyReaderError, OSError) as error:
            remedy = REPAIR.get(self.paths[0].suffix, "check that all files of the bag are there")
            raise InputError(f"{self.paths[0]}: the bag cannot be opened: {error}. If it was cut off: {remedy}") from error
        return self.reader

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        from rosbags.highlevel import AnyReaderError
        from rosbags.rosbag1 import ReaderError as ReaderError1
        from rosbags.rosbag2 import ReaderError as ReaderError2

        self.reader.close()
        if isinstance(error, AnyReaderError | ReaderError1 | ReaderError2 | OSError):
            raise InputError(f"{self.paths[0]}: the bag is damaged: {error}") from error
