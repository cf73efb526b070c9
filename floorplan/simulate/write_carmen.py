"""A simulated laser scan as a CARMEN log: one FLASER line per sweep."""

from pathlib import Path

import numpy as np

from floorplan.simulate.laser import BEAMS, MAX_RANGE_M, LaserScanner
from floorplan.simulate.odometry import Odometry
from floorplan.simulate.sensor import Shot
from floorplan.simulate.stamps import seconds_text
from floorplan.simulate.walk import Walk
from floorplan.simulate.wheels import slipping

LOG_NAME = "scan.clf"


class CarmenWriter:
    """Collects the sweeps' texts; the log is written at the end."""

    def __init__(self, folder: Path, instrument: LaserScanner, seed: int) -> None:
        self.folder, self._slips, self._seed = folder, instrument.slips, seed
        self._ranges: list[str] = []
        folder.mkdir(parents=True, exist_ok=True)

    def frame(self, index: int, shot: Shot) -> None:
        """One sweep; no return is written as the maximal range."""
        ranges = np.where(shot.depth_m[0] > 0, shot.depth_m[0], MAX_RANGE_M)
        self._ranges.append(" ".join(f"{value:.2f}" for value in ranges))

    def finish(self, walk: Walk, odometry: Odometry) -> None:
        """The log, with the slips of the wheels where they slip."""
        odometry = slipping(odometry, self._seed) if self._slips else odometry
        yaw = np.arctan2(odometry.odom_from_camera[:, 1, 0], odometry.odom_from_camera[:, 0, 0])
        lines = ["# FLASER num_readings [range_readings] x y theta odom_x odom_y odom_theta"]
        for index, ranges in enumerate(self._ranges):
            x, y = odometry.position_m[index, :2]
            pose, stamp = f"{x:.6f} {y:.6f} {yaw[index]:.6f}", seconds_text(int(walk.stamp_ns[index]))
            lines.append(f"FLASER {BEAMS} {ranges} {pose} {pose} {stamp} simulated {stamp}")
        (self.folder / LOG_NAME).write_text("\n".join(lines) + "\n")
