"""What a work folder holds: for each stage kept, stale and because of what, or missing."""

from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from floorplan.work.disk import size_bytes
from floorplan.work.fingerprint import scan_fingerprint
from floorplan.work.folder import Owner, partial_name, read_stage_record
from floorplan.work.recipe import differences, recipe_of
from floorplan.work.stages import STAGES, Stage


class StageState(StrEnum):
    KEPT = "kept"
    STALE = "stale"
    MISSING = "missing"
    PARTIAL = "partial"  # begun and interrupted: the next build continues inside


@dataclass(frozen=True)
class StageStatus:
    """One stage: `reasons` say why it is stale; `seconds` it took; `size_bytes` on disk, finished parts included."""

    folder: str
    state: StageState
    reasons: tuple[str, ...] = ()
    seconds: float | None = None
    size_bytes: int = 0


def current_owner(made_for: Owner, work: Path) -> Owner:
    """The same owner with the fingerprint its scan has now; unchanged where the scan is no longer there."""
    scan = Path(made_for.scan)
    if made_for.scans:
        return made_for  # of several scans, whose own folders tell what changed
    return replace(made_for, fingerprint=scan_fingerprint(scan, work)) if scan.exists() else made_for


def stages_status(work: Path, config: object, owner: Owner) -> tuple[StageStatus, ...]:
    """The state of every stage of `work`, were it built now under `config` from `owner`'s scan."""
    keys: dict[str, str] = {}
    states: list[StageStatus] = []
    for stage in STAGES:
        states.append(_stage_status(work, stage, config, owner, keys))
    return tuple(states)


def _stage_status(work: Path, stage: Stage, config: object, owner: Owner, keys: dict[str, str]) -> StageStatus:
    recipe = recipe_of(stage, config, keys, f"{owner.format} {owner.fingerprint}")
    keys[stage.folder] = recipe.key
    partial = work / partial_name(stage)
    size = sum(size_bytes(path) for path in (work / stage.folder, partial) if path.exists())
    made = read_stage_record(work, stage)
    if made is None:
        return StageStatus(stage.folder, StageState.PARTIAL if partial.exists() else StageState.MISSING, size_bytes=size)
    reasons = differences(made["recipe"], recipe)
    return StageStatus(stage.folder, StageState.STALE if reasons else StageState.KEPT, reasons, made["seconds"], size)
