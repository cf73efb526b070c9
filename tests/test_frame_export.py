"""The picture of one frame, from a finished work folder."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from floorplan.build import Job, build
from floorplan.config import Config
from floorplan.errors import UsageError
from floorplan.frame_export import export_frame
from floorplan.work.stages import SEGMENTS

SAMPLE = Path(__file__).resolve().parents[1] / "samples" / "flat"


def test_the_picture_of_a_frame_shows_the_walls_of_both_axes_the_floor_and_the_depth_beside_them(tmp_path: Path) -> None:
    build(Job(SAMPLE, tmp_path / "work", until=SEGMENTS))
    row = export_frame(tmp_path / "work", Config(), 40, tmp_path / "frame.png")
    assert abs(row - 40) < 15  # the nearest keyframe
    for beyond in (-1, 100_000):
        with pytest.raises(UsageError, match="frames 0 to"):
            export_frame(tmp_path / "work", Config(), beyond, tmp_path / "beyond.png")
    image = cv2.imread(str(tmp_path / "frame.png"))[..., ::-1]
    depth, labels = np.split(image.astype(int), 2, axis=1)
    assert (depth[..., 0] == depth[..., 1]).all()  # grey
    horizontal = (labels == (0, 0, 255)).all(axis=2).mean()
    upright = (labels == (255, 0, 0)).all(axis=2).mean() + (labels == (0, 255, 0)).all(axis=2).mean()
    assert 0.02 < horizontal < 0.9
    assert 0.1 < upright < 0.95

