"""Drawings that a build finds as the last one left them are not made again: the same plan, settings and writers give the same bytes."""

import hashlib
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from floorplan.config import Config
from floorplan.drawing_process import DrawingProcess
from floorplan.drawings import ALONE, Drawing, files_of, write_drawings
from floorplan.reporting import Reporter
from floorplan.results import Results
from floorplan.summary import Summary
from floorplan.work.code import code_fingerprint
from floorplan.work.disk import clear_disk_errors, new_file
from floorplan.work.stages import Stage
from floorplan.work.values import write_json

RECORD_NAME = "drawings.json"
_CODE = Stage("drawings", 1, (), ("drawings", "writers"))  # whatever a drawing's bytes depend on beside the plan


def draw_what_changed(
    results: Results,
    table: Summary,
    scan: Path,
    drawings: tuple[Drawing, ...],
    config: Config,
    reporter: Reporter,
    work: Path,
    second: DrawingProcess = ALONE,
) -> None:
    """Write the drawings whose plan, settings or file changed since `work` saw them last; the others stay as they are.

    A `second` process helps as in `write_drawings`.
    """
    if not drawings:
        return
    key, known = _key(table, scan, config), _record(work)
    stale = tuple(drawing for drawing in drawings if not _is_kept(known.get(_name(drawing)), key))
    for drawing in drawings:
        if drawing not in stale:
            reporter.message(f"{drawing.path} is up to date")
    write_drawings(results, table, scan, stale, config, reporter, second)
    for drawing in stale:
        files = files_of((drawing,), results.plan)
        known[_name(drawing)] = {"key": key, "files": {str(path.resolve()): _sha256(path) for path in files}}
    with clear_disk_errors(work), new_file(work / RECORD_NAME) as making:
        write_json(making, known)


def _key(table: Summary, scan: Path, config: Config) -> str:
    """What the bytes depend on: the plan by its key, the sheet's settings and template, the words on it, the writers' code."""
    template = _sha256(Path(config.drawing.template)) if config.drawing.template else ""
    parts = [table.key, scan.name, asdict(config.drawing), asdict(config.project), template, code_fingerprint(_CODE)]
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


def _is_kept(made: dict[str, Any] | None, key: str) -> bool:
    return made is not None and made["key"] == key and all(_sha256(Path(path)) == digest for path, digest in made["files"].items())


def _name(drawing: Drawing) -> str:
    return f"{drawing.format} {drawing.path.resolve()}"


def _record(work: Path) -> dict[str, Any]:
    path = work / RECORD_NAME
    return dict(json.loads(path.read_text("utf-8"))) if path.exists() else {}


def _sha256(path: Path) -> str:
    """Of a file's content; empty where there is none."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else ""
