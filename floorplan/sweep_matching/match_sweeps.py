"""Matches a laser's sweeps, learns from that what is wrong with the wheels all over, and matches again without it."""

from dataclasses import dataclass

from floorplan.model.scan import Recording, Wheels
from floorplan.readers.base import Source
from floorplan.reporting import Steps
from floorplan.sweep_matching.lever_arm import at_the_sensor, find_lever_arm
from floorplan.sweep_matching.refine import RefinedOdometry, level_poses, refine_odometry
from floorplan.sweep_matching.wheel_turn import find_wheel_turn, turned_right


@dataclass(frozen=True)
class MatchedSweeps:
    """The matched poses, and what was found wrong with the wheels, mended or not."""

    refined: RefinedOdometry
    wheels: Wheels


def match_sweeps(source: Source, recording: Recording, steps: Steps) -> MatchedSweeps:
    """Matched poses of every sweep; where the wheels are surely wrong all recording long, from odometry without that."""
    refined = refine_odometry(source, recording, steps("matching sweeps"))
    recorded = level_poses(recording)
    turn = find_wheel_turn(recorded, refined.pose)
    lever = find_lever_arm(recorded, refined.pose, refined.information)
    mended = recording
    if turn is not None and turn.applied:
        mended = turned_right(mended, turn)
    if lever is not None and lever.applied:
        mended = at_the_sensor(mended, lever)
    if mended is not recording:
        refined = refine_odometry(source, mended, steps("matching again, wheels mended"))
    return MatchedSweeps(refined, Wheels(lever, turn))
