"""A trajectory from depth and brightness images alone: frame to frame, coarse to fine, by Open3D's hybrid RGB-D odometry.

Method: Park, Zhou & Koltun 2017, "Colored Point Cloud Registration Revisited" (photometric and geometric error together);
depth alone (point to plane) where there is no brightness, which slides along corridors.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from floorplan.errors import InputError
from floorplan.geometry import quat_xyzw_from_rotation, rotation_from_quat_xyzw
from floorplan.model.checks import Array
from floorplan.model.scan import NANOSECONDS_PER_SECOND, POSES_MISSING, Frame, Problem, Recording
from floorplan.open3d_library import load_open3d
from floorplan.readers.base import Source
from floorplan.reporting import Progress

COLUMNS = 320  # finer images cost four times as much and move the result by less than frame-to-frame drift
ITERATIONS = (10, 8, 6)  # coarse to fine
LEAST_FITNESS = 0.3  # share of pixels that found a partner: with less the pair is believed not to match
MAX_DEPTH_M = 8.0
MAX_SPEED_M_S = 5.0  # a step that would need more is a wrong match: nobody walks a camera at a run
OUTLIER_M = 0.07  # a partner further off in depth is another surface


@dataclass(frozen=True)
class _Pair:
    """The motion between two frames: `before_from_after (4, 4)`, and whether the images matched."""

    before_from_after: Array
    matched: bool


def with_rgbd_odometry(source: Source, recording: Recording, progress: Progress) -> Recording:
    """The recording with poses made from its images; frames that do not match keep the last motion and are counted.

    Raises `InputError` for a sensor that is no pinhole camera.
    """
    pose, poses, lost = np.eye(4), [np.eye(4)], []
    for done, pair in enumerate(_pairs(source, recording), 1):
        pose = pose @ pair.before_from_after
        poses.append(pose)
        if not pair.matched:
            lost.append(done)
        progress(done, len(recording) - 1)
    stacked = np.stack(poses)
    rotation = rotation_from_quat_xyzw(quat_xyzw_from_rotation(stacked[:, :3, :3]))  # orthogonal again after many products
    kept = tuple(p for p in recording.problems if p.code != POSES_MISSING)
    told = Problem("odometry-computed", "the trajectory was made from the images", advice="it drifts more than a device's own")
    if lost:
        message = f"neighbouring images do not match (fitness below {LEAST_FITNESS}, or a step beyond {MAX_SPEED_M_S:g} m/s)"
        kept += (Problem("odometry-lost", message, f"frame {lost[0]}", len(lost), "the last motion is kept; record more slowly"),)
    return replace(recording, position_m=stacked[:, :3, 3], odom_from_sensor=rotation, problems=(*kept, told))


def _pairs(source: Source, recording: Recording) -> Iterator[_Pair]:
    open3d, lens = load_open3d(), recording.sensor.intrinsics
    if lens is None:
        raise InputError("ingest.odometry = rgbd needs depth images with intrinsics; this recording has none")
    stride = max(1, lens.width // COLUMNS)
    matrix = np.array([[lens.fx, 0, lens.cx], [0, lens.fy, lens.cy], [0, 0, stride]]) / stride
    before: Any = None
    last = np.eye(4)
    seconds = np.diff(recording.stamp_ns) / NANOSECONDS_PER_SECOND
    for frame in source.frames(range(len(recording)), stride):
        after = _image(open3d, frame) if isinstance(frame, Frame) else None
        if frame.index > 0:
            pair = _matched(open3d, before, after, matrix) if before is not None and after is not None else None
            if pair is not None and np.linalg.norm(pair[:3, 3]) > MAX_SPEED_M_S * seconds[frame.index - 1]:
                pair = None
            last = pair if pair is not None else last
            yield _Pair(last, pair is not None)
        before = after if after is not None else before


def _image(open3d: Any, frame: Frame) -> Any:
    """An RGBDImage; without brightness a black one."""
    depth = np.nan_to_num(frame.points[..., 2:3])
    grey = np.zeros(depth.shape[:2], dtype=np.uint8) if frame.grey is None else frame.grey
    colour = np.ascontiguousarray(np.repeat(grey[..., None], 3, axis=2))
    image, tensor = open3d.t.geometry.Image, open3d.core.Tensor
    return open3d.t.geometry.RGBDImage(image(tensor(colour)), image(tensor(np.ascontiguousarray(depth))))


def _matched(open3d: Any, before: Any, after: Any, matrix: Array) -> Array | None:
    """Motion (4, 4) from `after` to `before`; None where they do not match."""
    odometry, tensor = open3d.t.pipelines.odometry, open3d.core.Tensor
    criteria = [odometry.OdometryConvergenceCriteria(n) for n in ITERATIONS]
    dark = int(before.color.as_tensor().numpy().max()) == 0
    method = odometry.Method.PointToPlane if dark else odometry.Method.Hybrid
    loss = odometry.OdometryLossParams(OUTLIER_M)
    start = tensor(np.eye(4))
    found = odometry.rgbd_odometry_multi_scale(after, before, tensor(matrix), start, 1.0, MAX_DEPTH_M, criteria, method, loss)
    return np.asarray(found.transformation.numpy()) if found.fitness >= LEAST_FITNESS else None
