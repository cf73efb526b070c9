"""What every format is read through: a `Source` knows its recording and gives frames one at a time."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from floorplan.config import ReadConfig
from floorplan.model.scan import Frame, Problem, Recording


@dataclass(frozen=True)
class BadFrame:
    """A frame that could not be read, and why; it is counted and reported, never silently dropped."""

    index: int
    problem: Problem


class Source(Protocol):
    """An opened scan. Nothing but `recording` is held in memory; depth streams through `frames`."""

    @property
    def recording(self) -> Recording:
        """All of the scan except its depth."""
        ...

    def frames(self, indices: Iterable[int], stride: int = 1) -> Iterator[Frame | BadFrame]:
        """Frames of the given rows of `recording`, in that order, every `stride`-th pixel of each grid direction.

        Safe to call from several threads at once, each with its own iterator.
        """
        ...


class Reader(Protocol):
    """One format: a name, a sniffer that looks at names and first bytes only, and `open`.

    `description` says what the format is, `looks_for` which files make the sniffer recognise it.
    """

    @property
    def name(self) -> str: ...

    @property
    def description(self) -> str: ...

    @property
    def looks_for(self) -> str: ...

    def sniff(self, path: Path) -> bool:
        """True when `path` looks like this format."""
        ...

    def open(self, path: Path, config: ReadConfig) -> Source:
        """The opened scan. Raises `InputError` when it cannot be used at all."""
        ...
