"""A trajectory made from images alone."""

import shutil
from pathlib import Path

import numpy as np

from floorplan.config import IngestConfig
from floorplan.ingest import examine
from floorplan.readers import open_scan

FRAMES = 6  # of the real recording: a twentieth of a second apart or less


def test_a_real_recording_without_its_odometry_gets_a_trajectory_like_it(shared_data: Path, tmp_path: Path) -> None:
    source = shared_data / "rgbd" / "corridor"
    for name in ("intrinsics.json", "odometry.txt"):
        shutil.copy(source / name, tmp_path / name)
    for name in ("depth", "rgb"):
        (tmp_path / name).symlink_to(source / name)
        lines = (source / f"{name}.txt").read_text().splitlines()
        (tmp_path / f"{name}.txt").write_text("\n".join(lines[: FRAMES + 1]) + "\n")
    recorded = open_scan(tmp_path).recording
    (tmp_path / "odometry.txt").unlink()
    made = examine(open_scan(tmp_path), IngestConfig())
    assert [p.code for p in made.problems if p.code.startswith("odometry")] == ["odometry-computed"]
    assert 0.005 < np.linalg.norm(made.position_m[-1] - made.position_m[0]) < 0.5
    np.testing.assert_allclose(made.position_m, recorded.position_m, atol=0.03)
    np.testing.assert_allclose(made.odom_from_sensor, recorded.odom_from_sensor, atol=0.02)
