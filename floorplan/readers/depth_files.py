"""Which depth images of a recording are there and whole, found from their first and last bytes."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.scan import Problem
from floorplan.readers.png import png_head

DEPTH_BITS = 16


@dataclass(frozen=True)
class DepthFiles:
    """`present (N,)` the file exists; `whole (N,)` it is a 16-bit PNG of the common size `width` x `height`; problems met."""

    present: Array
    whole: Array
    width: int
    height: int
    problems: tuple[Problem, ...]


def look_at_depth_files(paths: Sequence[Path], folder: Path) -> DepthFiles:
    """Which of `paths` are there and whole. Raises `InputError` when not one is."""
    present = np.array([path.is_file() for path in paths], dtype=bool)
    if not present.any():
        raise InputError(f"{folder}: no frames: not one of the {len(paths)} depth images that should be there exists")
    heads = [png_head(path) if there else None for path, there in zip(paths, present, strict=True)]
    sizes = Counter((head.width, head.height) for head in heads if head and head.bits == DEPTH_BITS)
    if not sizes:
        first = paths[int(np.argmax(present))]
        raise InputError(f"{first}: no 16-bit greyscale PNG, and neither is any other depth image; export the depth as 16-bit PNG")
    (width, height), _ = sizes.most_common(1)[0]
    whole = np.array([h is not None and h.whole and (h.width, h.height, h.bits) == (width, height, DEPTH_BITS) for h in heads])
    problems = [
        _problem("frame-missing", "depth images listed but not there", ~present, paths),
        _problem("png-unreadable", f"depth images damaged, or not {width} x {height} of 16 bit", present & ~whole, paths),
    ]
    return DepthFiles(present, whole, width, height, tuple(p for p in problems if p))


def _problem(code: str, message: str, affected: Array, paths: Sequence[Path]) -> Problem | None:
    if not affected.any():
        return None
    advice = "these frames are left out; copy the recording again"
    return Problem(code, message, str(paths[int(np.argmax(affected))]), int(affected.sum()), advice)
