"""The lock that keeps two builds out of one work folder; it dies with the process that holds it."""

import fcntl
import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from floorplan.errors import WorkFolderError

LOCK_NAME = ".lock"


@dataclass(frozen=True)
class Holder:
    """Who took the lock: process, machine, local time."""

    pid: int
    host: str
    since: str

    def __str__(self) -> str:
        return f"process {self.pid} on {self.host}, since {self.since}"


@contextmanager
def locked(folder: Path) -> Iterator[Holder | None]:
    """Hold the lock of `folder`; gives the holder a killed build left behind, if any.

    Raises `WorkFolderError` naming the holder when another process has it. The system frees the lock of a process
    that died, so a stale one never has to be removed by hand.
    """
    with (folder / LOCK_NAME).open("a+", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise WorkFolderError(f"{folder}: another build is at work here ({_read_holder(file.name)}); wait for it, or end it") from error
        left_behind = _read_holder(file.name)
        file.truncate(0)
        json.dump(asdict(Holder(os.getpid(), socket.gethostname(), time.strftime("%Y-%m-%d %H:%M:%S"))), file)
        file.flush()
        try:
            yield left_behind
        finally:
            file.truncate(0)


def _read_holder(path: str) -> Holder | None:
    text = Path(path).read_text("utf-8")
    return Holder(**json.loads(text)) if text else None
