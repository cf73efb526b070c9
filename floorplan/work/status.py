"""What a work folder holds: for each stage kept, stale and because of what, or missing."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from floorplan.work.disk import size_bytes
from floorplan.work.folder import Owner, read_stage_record
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
    partial = work / f"{stage.folder}.partial"
    size = sum(size_bytes(path) for path in (work / stage.folder, partial) if path.exists())
    made = read_stage_record(work, stage)
    if made is None:
        return StageStatus(stage.folder, StageState.PARTIAL if partial.exists() else StageState.MISSING, size_bytes=size)
    reasons = differences(made["recipe"], recipe)
    return StageStatus(stage.folder, StageState.STALE if reasons else StageState.KEPT, reasons, made["seconds"], size)
