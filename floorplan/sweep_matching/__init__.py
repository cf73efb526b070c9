"""Matching sweeps with the surfaces just seen: better odometry for lasers on wheels."""

from floorplan.sweep_matching.match_sweeps import MatchedSweeps, match_sweeps
from floorplan.sweep_matching.refine import RefinedOdometry, refine_odometry, with_level_poses

__all__ = ["MatchedSweeps", "RefinedOdometry", "match_sweeps", "refine_odometry", "with_level_poses"]
