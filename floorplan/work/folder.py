"""The work folder itself: keeps each stage's result under its key, and makes only what is missing or stale."""

import json
import shutil
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from floorplan.errors import WorkFolderError
from floorplan.reporting import Reporter, SilentReporter
from floorplan.work.chunks import ChunkStore
from floorplan.work.disk import clear_disk_errors, need_folder, new_file, new_folder
from floorplan.work.recipe import Recipe, differences, recipe_of
from floorplan.work.stages import STAGES, Stage
from floorplan.work.values import load_value, save_value, write_json

T = TypeVar("T")
OWNER_NAME = "work.json"
PART_PREFIX = "scan-"  # and a number from 1: the work folder of one scan of several, inside theirs


@dataclass(frozen=True)
class Owner:
    """The scan a work folder belongs to: where it lay, the format it was read as, its fingerprint.

    Of several scans joined, `scan` is their names and `scans` where they lay; each has a work folder of its own inside.
    """

    scan: str
    format: str
    fingerprint: str
    scans: tuple[str, ...] = ()


class UntilReached(Exception):  # noqa: N818  (not an error: the job was asked to stop here)
    """The job was asked to stop before this stage."""


@dataclass
class WorkFolder:
    """Stages of one scan under one configuration. `redo_from`: made again from there on; `until`: the last one made."""

    path: Path
    owner: Owner
    config: object
    redo_from: Stage | None = None
    until: Stage | None = None
    reporter: Reporter = field(default_factory=SilentReporter)
    keys: dict[str, str] = field(default_factory=dict)

    def forget_redone(self) -> None:
        """Throw away what is to be made again, before anything is made: an interrupted build is gone on with from there."""
        for stage in STAGES:
            if self._is_redone(stage):
                for name in (stage.folder, partial_name(stage)):
                    shutil.rmtree(self.path / name, ignore_errors=True)

    def stage(self, stage: Stage, kind: type[T], make: Callable[[], T], counts: Callable[[T], Mapping[str, int]] = lambda value: {}) -> T:
        """The result of `stage`: read when its key matches, otherwise made, kept and given back.

        `counts` names the main numbers of the result for the log and `stage.json`. Raises `UntilReached` past `until`.
        """
        if self.until is not None and STAGES.index(stage) > STAGES.index(self.until):
            raise UntilReached
        recipe = self.recipe(stage)
        self.keys[stage.folder] = recipe.key
        reason = self._why_made(stage, recipe)
        if not reason:
            shutil.rmtree(self.path / partial_name(stage), ignore_errors=True)  # of a build that ended just before it could
            return load_value(self.path / stage.folder, kind)
        self.reporter.detail(f"{stage.folder}: {reason}")
        begin = time.perf_counter()
        value = make()
        self._keep(stage, recipe, value, time.perf_counter() - begin, dict(counts(value)))
        return value

    def recipe(self, stage: Stage) -> Recipe:
        """What `stage` would be made with now."""
        return recipe_of(stage, self.config, self.keys, f"{self.owner.format} {self.owner.fingerprint}")

    def chunks(self, stage: Stage) -> ChunkStore:
        """The finished parts of `stage`, kept until it is whole; thrown away when it is to be made again."""
        if self._is_redone(stage):
            shutil.rmtree(self.path / partial_name(stage), ignore_errors=True)
        return ChunkStore(self.path / partial_name(stage), self.recipe(stage))

    def _is_redone(self, stage: Stage) -> bool:
        return self.redo_from is not None and STAGES.index(stage) >= STAGES.index(self.redo_from)

    def _why_made(self, stage: Stage, recipe: Recipe) -> str:
        if self._is_redone(stage):
            return "made again, as asked for"
        made = read_stage_record(self.path, stage)
        return "not made yet" if made is None else "; ".join(differences(made["recipe"], recipe))

    def _keep(self, stage: Stage, recipe: Recipe, value: object, seconds: float, counts: dict[str, int]) -> None:
        final = self.path / stage.folder
        with clear_disk_errors(final), new_folder(final) as making:
            save_value(making, value)
            record = {"key": recipe.key, "recipe": recipe.as_json(), "seconds": round(seconds, 3), "counts": counts}
            write_json(making / "stage.json", record)
        shutil.rmtree(self.path / partial_name(stage), ignore_errors=True)
        numbers = ", ".join(f"{count} {name}" for name, count in counts.items())
        self.reporter.message(f"{stage.folder}  {seconds:.1f} s  {numbers}")


def partial_name(stage: Stage) -> str:
    """The folder that holds the finished chunks of an unfinished stage."""
    return f"{stage.folder}.partial"


def read_stage_record(work: Path, stage: Stage) -> dict[str, Any] | None:
    """The `stage.json` of a finished stage (key, recipe, seconds, counts), None where there is none."""
    path = work / stage.folder / "stage.json"
    return json.loads(path.read_text("utf-8")) if path.exists() else None


def read_owner(work: Path) -> Owner:
    """Whose work folder this is. Raises `WorkFolderError` when `work` is none."""
    path = work / OWNER_NAME
    if not path.exists():
        raise WorkFolderError(f"{work} is not a work folder (no {OWNER_NAME} in it); 'floorplan build SCAN' makes one")
    tree = json.loads(path.read_text("utf-8"))
    return Owner(**(tree | {"scans": tuple(tree.get("scans", ()))}))


def is_part(path: Path) -> bool:
    """Whether `path` is the work folder of one scan of several, inside theirs."""
    return path.name.startswith(PART_PREFIX) and (path / OWNER_NAME).exists()


def part_folders(work: Path) -> tuple[Path, ...]:
    """The work folders of the single scans that `work` joins, in order; none where it holds one recording."""
    return tuple(work / f"{PART_PREFIX}{number}" for number in range(1, len(read_owner(work).scans) + 1))


def claim(work: Path, owner: Owner) -> None:
    """Make `work` the folder of `owner`'s scan. Raises `WorkFolderError` when it belongs to another scan or holds other things."""
    need_folder(work)
    with clear_disk_errors(work):
        if (work / OWNER_NAME).exists():
            known = read_owner(work)
            if known.fingerprint != owner.fingerprint and (known.scan, known.scans) != (owner.scan, owner.scans):
                raise WorkFolderError(f"{work} was made from another scan ({known.scan}); choose another folder with --work, or delete it")
        elif any(path.name != ".lock" and not is_part(path) for path in work.iterdir()):
            raise WorkFolderError(f"{work} exists and is not a work folder; choose an empty or new one with --work")
        with new_file(work / OWNER_NAME) as making:
            write_json(making, asdict(owner))
