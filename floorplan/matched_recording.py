"""A level laser's recording under the trajectory that its own sweeps tell: matched to each other, loops closed."""

from dataclasses import dataclass, replace

from floorplan.loop_closing import close_loops
from floorplan.matching_problems import matching_problems
from floorplan.model.checks import Array
from floorplan.model.scan import Recording, Wheels
from floorplan.readers.base import Source
from floorplan.reporting import Steps
from floorplan.sweep_matching import match_sweeps, with_level_poses


@dataclass(frozen=True)
class MatchedRecording:
    """`recording` with the matched trajectory, what matching complains of among its problems; `map_sigma_m` as in `IngestedScan`."""

    recording: Recording
    map_sigma_m: Array | None
    wheels: Wheels


def matched_recording(source: Source, recording: Recording, closing: bool, steps: Steps) -> MatchedRecording:
    """The recording with its sweeps matched; with loops closed where `closing` says so."""
    matched = match_sweeps(source, recording, steps)
    refined = matched.refined
    closed = close_loops(refined, steps("closing loops")) if closing else None
    recording = replace(recording, problems=recording.problems + matching_problems(recording, matched, closed))
    recording = with_level_poses(recording, refined.pose if closed is None else closed.pose)
    return MatchedRecording(recording, None if closed is None else closed.sigma_m, matched.wheels)
