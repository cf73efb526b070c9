"""The one thing a simulated scan tells about itself: whether it ends where it began."""

import json
from pathlib import Path


def returns_to_start(folder: Path) -> bool | None:
    """`returns_to_start` of the truth file beside a simulated scan; None where there is none. Nothing else of it is read."""
    file = folder / "truth.json"
    if not file.is_file():
        return None
    try:
        said = json.loads(file.read_text(encoding="utf-8"))
    except ValueError:
        return None  # not our truth file: a recording may hold anything
    value = said.get("returns_to_start") if isinstance(said, dict) else None
    return value if isinstance(value, bool) else None
