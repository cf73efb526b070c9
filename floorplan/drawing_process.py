"""A second process that draws: a library slow to import is loaded while the plan is still made, and two drawings are written at a time.

The process is a help, nothing more: where it cannot take the drawings, fails or is killed, they are made by the one that asked.
"""

import pickle
import subprocess
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from floorplan.writers import Job

SLOW_LIBRARIES = (("pdf", "png"), ("dxf",))  # formats that share one; the first takes as long as all other formats together


@dataclass
class DrawingProcess:
    """Draws those of the formats `asked` for that share the slowest library; none where there is but one of `jobs`."""

    asked: tuple[str, ...] = ()
    jobs: int = 1
    _process: "subprocess.Popen[bytes] | None" = field(default=None, init=False)

    @property
    def formats(self) -> tuple[str, ...]:
        """The formats it draws."""
        shared = (tuple(name for name in library if name in self.asked) for library in SLOW_LIBRARIES)
        return next((formats for formats in shared if formats and self.jobs > 1 and sys.executable), ())

    def begin(self) -> None:
        """Start it ahead of `send`, so that its library is loaded by then."""
        if self.formats and self._process is None:
            command = [sys.executable, "-m", "floorplan.drawing_process", *self.formats]
            with suppress(OSError):  # no memory for another process
                self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def send(self, job: "Job", files: Sequence[tuple[str, Path]]) -> bool:
        """Have it write `files`, each with its format; whether it took them: not when it was not begun or has ended already."""
        if self._process is None or self._process.stdin is None or not files:
            return False
        try:
            with self._process.stdin as pipe:
                pickle.dump((job, tuple(files)), pipe)
        except BrokenPipeError:
            return False
        return True

    def succeeded(self) -> bool:
        """Whether everything it took is written, once it has ended."""
        return self._process is not None and self._process.wait() == 0

    def end(self) -> None:
        """Stop it where it still runs: the job failed, or there was nothing to draw."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None


def draw_as_told(formats: Iterable[str]) -> None:
    """What the second process does: read the job from standard input while the library of `formats` loads, then write its files."""
    with ThreadPoolExecutor(1) as reader:
        told = reader.submit(sys.stdin.buffer.read)
        from floorplan import writers

        for name in formats:
            writers.load_library(name)
        job, files = pickle.loads(told.result())
    for name, path in files:
        writers.write_job(name, job, path)


if __name__ == "__main__":
    draw_as_told(sys.argv[1:])
