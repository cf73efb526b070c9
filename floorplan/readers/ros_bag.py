"""ROS 1 and ROS 2 bags as a stream of messages, whole ones and cut ones: the one module that imports rosbags."""

import struct
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from floorplan.errors import InputError
from floorplan.model.scan import Problem
from floorplan.readers.cut_bag import METADATA, CutContents, bag_files, cut_contents, cut_files

BAG_SUFFIXES = (".bag", ".db3", ".mcap")
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
    with _opened(paths) as bag:
        return bag.topics()


def bag_problems(paths: tuple[Path, ...]) -> tuple[Problem, ...]:
    """What is wrong with the bag as a whole: how much is missing of one that was cut off."""
    files = cut_files(paths)
    if files:
        return (cut_contents(files).problem(),)
    with _opened(paths) as bag:
        if not bag.damage:
            return ()
        message = f"the bag's index is damaged: {bag.damage}"
        return (Problem("file-damaged", message, str(paths[0]), advice="it was read record by record; what could be had is used"),)


def messages(paths: tuple[Path, ...], topics: Collection[str], log_ns: Collection[int] = ()) -> Iterator[BagMessage]:
    """Messages of some topics in the order of writing, one in memory at a time; only those written at `log_ns`, unless empty.

    Raises `InputError` where the bag turns out to be damaged, after what could be read before and behind the damage; of messages asked for
    by their times it gives those that can be had.
    """
    wanted = frozenset(log_ns)
    start, stop = (min(wanted), max(wanted) + 1) if wanted else (None, None)
    with _opened(paths) as bag:
        last_ns = (start or 0) - 1
        try:
            for message in bag.messages(topics, wanted, start, stop):
                last_ns = message.log_ns
                yield message
        except _damages() as error:
            behind = _CutBag(cut_contents(bag_files(paths)))
            yield from behind.messages(topics, wanted, last_ns + 1, stop)
            if not wanted:
                raise InputError(f"{paths[0]}: the bag is damaged: {error}") from error


def _of_a_definition(error: BaseException | None) -> bool:
    """Whether nothing is wrong with the bag but a definition that cannot be parsed."""
    from rosbags.typesys import TypesysError

    return error is not None and (isinstance(error, TypesysError) or _of_a_definition(error.__cause__ or error.__context__))


def _damages() -> tuple[type[Exception], ...]:
    """What reading damaged bytes raises, in rosbags and below it: lengths, numbers, names and compressed data that make no sense."""
    import apsw
    from backports import zstd
    from rosbags.highlevel import AnyReaderError
    from rosbags.rosbag1 import ReaderError as ReaderError1
    from rosbags.rosbag2 import ReaderError as ReaderError2
    from rosbags.serde import SerdeError
    from rosbags.typesys import TypesysError

    theirs = (AnyReaderError, ReaderError1, ReaderError2, SerdeError, TypesysError, zstd.ZstdError, apsw.Error)
    return (*theirs, OSError, EOFError, ValueError, LookupError, ArithmeticError, MemoryError, AssertionError, RuntimeError, struct.error)


class _Bag(Protocol):
    """An open bag, whole or cut; `damage` is what keeps a bag that seems whole from being opened as such."""

    @property
    def damage(self) -> str: ...

    def topics(self) -> tuple[Topic, ...]: ...

    def messages(self, topics: Collection[str], wanted: frozenset[int], start: int | None, stop: int | None) -> Iterator[BagMessage]:
        """Decoded messages; only those written at the `wanted` times, unless there are none."""
        ...


@dataclass(frozen=True)
class _WholeBag:
    reader: Any
    damage: str = ""

    def topics(self) -> tuple[Topic, ...]:
        return tuple(Topic(name, info.msgtype or "", info.msgcount) for name, info in sorted(self.reader.topics.items()))

    def messages(self, topics: Collection[str], wanted: frozenset[int], start: int | None, stop: int | None) -> Iterator[BagMessage]:
        connections = [c for c in self.reader.connections if c.topic in topics]
        if not connections:
            return
        for connection, written_ns, raw in self.reader.messages(connections, start=start, stop=stop):
            if not wanted or written_ns in wanted:
                yield BagMessage(connection.topic, connection.msgtype, written_ns, self.reader.deserialize(raw, connection.msgtype))


@dataclass(frozen=True)
class _CutBag:
    contents: CutContents
    damage: str = ""

    def topics(self) -> tuple[Topic, ...]:
        return tuple(Topic(topic.name, topic.type, topic.count) for topic in self.contents.topics)

    def messages(self, topics: Collection[str], wanted: frozenset[int], start: int | None, stop: int | None) -> Iterator[BagMessage]:
        types = {topic.name: topic.type for topic in self.contents.topics}
        store, ros1 = _types_of(self.contents), self.contents.files[0].suffix == ".bag"
        decode = store.deserialize_ros1 if ros1 else store.deserialize_cdr
        for type in {types[topic] for topic in topics if topic in types} - set(store.fielddefs):
            raise InputError(f"{self.contents.files[0]}: the bag's definition of {type} cannot be read; record usual messages")
        for topic, written_ns, raw in self.contents.messages(topics, start, stop):
            if not wanted or written_ns in wanted:
                yield BagMessage(topic, types[topic], written_ns, decode(raw, types[topic]))


def _types_of(contents: CutContents) -> Any:
    """The usual message types, replaced by those that the bag defines itself; what cannot be parsed (events of services) is left out."""
    from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore

    ros1 = contents.files[0].suffix == ".bag"
    types = dict(get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE).fielddefs)
    for told in contents.definitions:
        try:
            idl = told.encoding == "ros2idl"
            types.update(get_types_from_idl(told.definition) if idl else get_types_from_msg(told.definition, told.type))
        except TypesysError:
            continue  # of a topic nobody asks for; where it is asked for, the missing type is an error
    store = get_typestore(Stores.EMPTY)
    store.register(types)
    return store


class _opened:  # noqa: N801 - a context manager, used like a function
    """An open reader; whatever rosbags says against the bag becomes an `InputError`."""

    def __init__(self, paths: tuple[Path, ...]) -> None:
        self.paths = paths
        self.reader: Any = None

    def __enter__(self) -> _Bag:
        files = cut_files(self.paths)
        if files and (contents := cut_contents(files)).blocks:
            return _CutBag(contents)
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore

        try:
            self.reader = AnyReader(self.paths, default_typestore=get_typestore(Stores.ROS2_HUMBLE))
            self.reader.open()
        except _damages() as error:
            if (plain := self._record_by_record("" if _of_a_definition(error) else str(error))) is not None:
                return plain
            remedy = REPAIR.get(self.paths[0].suffix, "check that all files of the bag are there")
            raise InputError(f"{self.paths[0]}: the bag cannot be opened: {error}. If it was cut off: {remedy}") from error
        return _WholeBag(self.reader)

    def _record_by_record(self, damage: str) -> _Bag | None:
        """The same files without rosbags, which gives up on one definition it cannot parse; None where they hold nothing either."""
        self.reader = None
        contents = cut_contents(bag_files(self.paths))
        return _CutBag(contents, damage) if contents.blocks else None

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if self.reader is not None:
            self.reader.close()
