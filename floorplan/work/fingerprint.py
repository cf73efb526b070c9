"""The fingerprint of a recording: equal when the files are, wherever they lie."""

import hashlib
import os
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

TRUTH_NAME = "truth.json"  # of a simulated scan; no stage reads it
FULLY_READ_BYTES = 256_000_000  # recordings up to this size are hashed whole (about 0.3 s) ...
SAMPLED_FILES = 200  # ... larger ones by the names and sizes of all files and the content of this many
BLOCK_BYTES = 1 << 20


def begun_fingerprint(scan: Path, work: Path) -> "Future[str]":
    """`scan_fingerprint` begun on a thread of its own: reading and hashing leave the interpreter to the program's start."""
    pool = ThreadPoolExecutor(1)
    begun = pool.submit(scan_fingerprint, scan, work)
    pool.shutdown(wait=False)
    return begun


def scan_fingerprint(scan: Path, work: Path) -> str:
    """SHA-256 over names, sizes and contents of the scan's files, the `work` folder left out."""
    files = sorted(_files(scan, work.resolve()))
    sizes = [path.stat().st_size for path in files]
    step = 1 if sum(sizes) <= FULLY_READ_BYTES else max(1, len(files) // SAMPLED_FILES)
    digest = hashlib.sha256()
    for number, (path, size) in enumerate(zip(files, sizes, strict=True)):
        name = path.name if path == scan else path.relative_to(scan).as_posix()
        digest.update(f"{name}\0{size}\0".encode())
        if number % step == 0:
            _add_content(digest, path, FULLY_READ_BYTES if step == 1 else BLOCK_BYTES)
    return digest.hexdigest()


def _files(scan: Path, work: Path) -> Iterator[Path]:
    if scan.is_file():
        yield scan
    for folder, names, files in os.walk(scan):
        names[:] = [name for name in names if (Path(folder) / name).resolve() != work]
        yield from (Path(folder) / name for name in files if name != TRUTH_NAME)


def _add_content(digest: "hashlib._Hash", path: Path, limit: int) -> None:
    with path.open("rb") as file:
        while limit > 0 and (block := file.read(min(BLOCK_BYTES, limit))):
            digest.update(block)
            limit -= len(block)
