"""The six stages: their folders, versions, config sections and inputs. `version` is that of the kept values' layout."""

from dataclasses import dataclass

from floorplan.errors import UsageError

# settings that no stage's result depends on: what only the summary reads, and where a file lies whose content counts
REPORTED_ONLY = frozenset({"ingest.returns_to_start", "corrections.laser_file", "edits.edits_file"})


@dataclass(frozen=True)
class Stage:
    """One stage: `sections` of the configuration it reads, `modules` its code starts in, `inputs` folders of the stages it reads."""

    folder: str
    version: int
    sections: tuple[str, ...]
    modules: tuple[str, ...]
    inputs: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """The folder's name without its number: what `--from` and `--until` take."""
        return self.folder.split("-", 1)[1]


INGEST = Stage("1-ingest", 1, ("read", "ingest"), ("ingest", "readers", "trim", "several.join", "several.lay", "several.start"))
SEGMENTS = Stage("2-segments", 1, ("compass", "segments"), ("chunked_segments", "readers", "several.turned"), ("1-ingest",))
LEAST_SQUARES = Stage("3-least-squares", 3, ("tracking", "least_squares"), ("initial_layout",), ("1-ingest", "2-segments"))
MERGE = Stage("4-merge", 2, ("merge", "edits"), ("merge", "edits.merges"), ("3-least-squares",))
RESOLVE = Stage("5-resolve", 2, ("resolve", "corrections"), ("resolve", "laser.calibrate", "laser.table"), ("3-least-squares", "4-merge"))
PLAN = Stage(
    "6-plan",
    1,
    ("plan", "edits"),
    ("plan.make_plan", "trajectory", "edits.plans", "second_direction"),
    ("1-ingest", "2-segments", "3-least-squares", "5-resolve"),
)
STAGES = (INGEST, SEGMENTS, LEAST_SQUARES, MERGE, RESOLVE, PLAN)


def check_order(redo_from: Stage | None, until: Stage | None) -> None:
    """Raise `UsageError` where a build would stop before the stage it begins at."""
    if redo_from is not None and until is not None and STAGES.index(redo_from) > STAGES.index(until):
        raise UsageError(f"--from {redo_from.name} comes after --until {until.name}: nothing would be made; exchange them or leave one out")


def stage_named(name: str) -> Stage:
    """The stage of that name (`merge`, or the folder's name `4-merge`). Raises `UsageError` for any other word."""
    for stage in STAGES:
        if name in (stage.name, stage.folder):
            return stage
    raise UsageError(f"no stage is called '{name}'; the stages are {', '.join(s.name for s in STAGES)}")
