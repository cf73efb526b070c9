"""Bags that were cut off or never closed: read what is there, and say how much that is."""

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import lru_cache
from heapq import heappop, heappush
from pathlib import Path

from floorplan.model.scan import NANOSECONDS_PER_SECOND, Problem
from floorplan.readers.cut_mcap import CutMcap
from floorplan.readers.cut_records import CutFormat, RawDefinition, RawMessage, RawTopic
from floorplan.readers.cut_rosbag1 import CutRosbag1
from floorplan.readers.cut_sqlite import CutSqlite

METADATA = "metadata.yaml"
FORMATS: dict[str, CutFormat] = {".bag": CutRosbag1(), ".mcap": CutMcap(), ".db3": CutSqlite()}


@dataclass(frozen=True)
class Block:
    """A piece of a file that holds messages, and the times between which they were written."""

    file: int
    offset: int
    first_ns: int
    last_ns: int


@dataclass(frozen=True)
class CutTopic:
    """A topic of the whole bag: its type as the bag writes it, and how many whole messages are left."""

    name: str
    type: str
    count: int


@dataclass(frozen=True)
class CutContents:
    """What one pass over a cut bag finds. `names[k]` gives the topic of a number in file k."""

    files: tuple[Path, ...]
    topics: tuple[CutTopic, ...]
    definitions: tuple[RawDefinition, ...]
    blocks: tuple[Block, ...]
    names: tuple[dict[int, str], ...]

    def messages(self, topics: Collection[str], start_ns: int | None, stop_ns: int | None) -> Iterator[tuple[str, int, bytes]]:
        """Topic, time of writing and bytes of each message, in the order of writing."""
        start, stop = start_ns or 0, stop_ns or max((block.last_ns for block in self.blocks), default=0) + 1
        blocks = sorted((b for b in self.blocks if b.last_ns >= start and b.first_ns < stop), key=lambda b: b.first_ns)
        waiting: list[tuple[int, int, str, bytes]] = []
        for number, block in enumerate(blocks):
            for message in self._block(block):
                name = self.names[block.file].get(message.topic, "")
                if name in topics and start <= message.log_ns < stop:
                    heappush(waiting, (message.log_ns, len(waiting), name, message.raw))
            end = blocks[number + 1].first_ns if number + 1 < len(blocks) else stop
            while waiting and waiting[0][0] < end:
                log_ns, _, name, raw = heappop(waiting)
                yield name, log_ns, raw

    def _block(self, block: Block) -> Iterator[RawMessage]:
        path = self.files[block.file]
        with path.open("rb") as file:
            yield from (r for r in FORMATS[path.suffix].records(file, block.offset) if isinstance(r, RawMessage))

    def problem(self) -> Problem:
        """How much of the bag could be read."""
        count = sum(topic.count for topic in self.topics)
        times = [t for block in self.blocks for t in (block.first_ns, block.last_ns)]
        seconds = (max(times) - min(times)) / NANOSECONDS_PER_SECOND if times else 0.0
        listed = _listed_messages(self.files[0].parent)
        of = f" of {listed}" if listed else ""
        size = sum(file.stat().st_size for file in self.files)
        full = sum(max(FORMATS[file.suffix].full_size(file), file.stat().st_size) for file in self.files)
        share = f"{size} of at least {full} bytes are there" if full > size else f"{size} bytes are there"
        message = f"the bag was cut off or not closed: {count}{of} messages over {seconds:.1f} s could be read; {share}"
        return Problem("bag-cut", message, str(self.files[0]), advice="the plan shows what was read")


def cut_files(paths: tuple[Path, ...]) -> tuple[Path, ...]:
    """All files of the bag when one of them is cut off or not there; empty when the bag is whole."""
    folder = paths[0] if paths[0].is_dir() else None
    files = bag_files(paths)
    if any(FORMATS[file.suffix].is_cut(file) for file in files):
        return files
    listed = _listed_files(folder) if folder is not None else set()
    return files if listed - {file.name for file in files} else ()


def bag_files(paths: tuple[Path, ...]) -> tuple[Path, ...]:
    """The files of a bag given as such or as their folder."""
    return paths if not paths[0].is_dir() else tuple(sorted(f for f in paths[0].iterdir() if f.suffix in FORMATS))


def cut_contents(files: tuple[Path, ...]) -> CutContents:
    """What is in the files; looked through once as long as they do not change."""
    return _contents(files, tuple((file.stat().st_size, file.stat().st_mtime_ns) for file in files))


@lru_cache(maxsize=2)
def _contents(files: tuple[Path, ...], _state: tuple[tuple[int, int], ...]) -> CutContents:
    seen = [_look_through(number, file) for number, file in enumerate(files)]
    counts: dict[tuple[str, str], int] = {}
    for one in seen:
        for topic in one.topics:
            counts[topic.name, topic.type] = counts.get((topic.name, topic.type), 0) + topic.count
    return CutContents(
        files,
        tuple(CutTopic(name, type, count) for (name, type), count in sorted(counts.items())),
        tuple({d.type: d for one in seen for d in one.definitions}.values()),
        tuple(block for one in seen for block in one.blocks),
        tuple(names for one in seen for names in one.names),
    )


def _look_through(number: int, path: Path) -> CutContents:
    """One file: topics with their counts, definitions, blocks with their times."""
    topics: dict[int, RawTopic] = {}
    definitions: dict[str, RawDefinition] = {}
    counts: dict[int, int] = {}
    blocks = []
    with path.open("rb") as file:
        for offset in list(FORMATS[path.suffix].blocks(file)):
            times = []
            for record in FORMATS[path.suffix].records(file, offset):
                if isinstance(record, RawMessage):
                    times.append(record.log_ns)
                    counts[record.topic] = counts.get(record.topic, 0) + 1
                elif isinstance(record, RawTopic):
                    topics[record.id] = record
                else:
                    definitions[record.type] = record
            if times:
                blocks.append(Block(number, offset, min(times), max(times)))
    schemas = {d.schema: d.type for d in definitions.values()}
    told = tuple(CutTopic(t.name, t.type or schemas.get(t.schema, ""), counts.get(id, 0)) for id, t in topics.items())
    return CutContents((path,), told, tuple(definitions.values()), tuple(blocks), ({id: t.name for id, t in topics.items()},))


def _metadata(folder: Path) -> str:
    file = folder / METADATA
    return file.read_text(errors="replace") if file.is_file() else ""


def _listed_messages(folder: Path) -> int:
    """Messages that metadata.yaml promises; 0 without."""
    found = re.search(r"^ *message_count: *(\d+)", _metadata(folder), re.MULTILINE)  # the first one is the whole bag's
    return int(found[1]) if found else 0


def _listed_files(folder: Path) -> set[str]:
    """Bag files that metadata.yaml names."""
    return set(re.findall(r"^ *- *([^\s:]+\.(?:db3|mcap)) *$", _metadata(folder), re.MULTILINE))
