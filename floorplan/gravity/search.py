"""Which way is up in the odometry's world, for a recording as a whole.

People and robots hold a camera the same way up: the image's own up direction (or, upright phones, its left or right) stays
near the vertical however they turn. Floors and ceilings then say the vertical to a degree.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from floorplan.gravity.horizontal import mean_axis
from floorplan.gravity.normals import OrientedPoints
from floorplan.model.checks import Array

IMAGE_UPS = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])  # landscape, and the two ways to hold a phone upright
LANDSCAPE_BONUS = 0.1  # in cosine: upright only when it fits clearly better
STEADY_PERCENTILE = 15.0  # so many of 100 frames may look steeply up or down
MIN_STEADINESS = 0.5  # cosine: the image's up within 60 degrees of the vertical in the other frames
WIDE_RAD, MIDDLE_RAD = np.deg2rad(25.0), np.deg2rad(12.0)  # normals taken for horizontal while closing in on the vertical
MIN_SHARE = 0.02  # of all normals that must be vertical
POINTS_PER_FRAME = 2000  # enough for a share of 2 %


@dataclass(frozen=True)
class WorldNormals:
    """Normals of sampled frames in the odometry's world: `normal (P, 3)`; `image_up (F, 3, 3)` frame, candidate of IMAGE_UPS, xyz."""

    normal: Array
    image_up: Array


@dataclass(frozen=True)
class UpInWorld:
    """`up_world (3,)`; `share` of the normals that are vertical; `steadiness` cosine between image and vertical."""

    up_world: Array
    share: float
    steadiness: float


def world_normals(frames: Sequence[tuple[OrientedPoints, Array]]) -> WorldNormals:
    """Normals of all frames turned into the odometry's world; each comes with its odom_from_sensor (3, 3)."""
    turned = []
    for oriented, rotation in frames:
        step = max(1, len(oriented) // POINTS_PER_FRAME)
        turned.append(oriented.normal[::step] @ rotation.T)
    return WorldNormals(np.concatenate(turned), np.einsum("fij,uj->fui", np.array([rotation for _, rotation in frames]), IMAGE_UPS))


def search_up(seen: WorldNormals) -> UpInWorld | None:
    """The vertical of the odometry's world, or None when no direction is both steady in the image and seen as floor or ceiling."""
    means = seen.image_up.mean(axis=0)
    long_enough = means[np.linalg.norm(means, axis=1) > MIN_STEADINESS]
    candidates = np.concatenate([np.eye(3), -np.eye(3), long_enough])
    rated = [_rated(seen, candidate / np.linalg.norm(candidate)) for candidate in candidates]
    good = [r for r in rated if r.share >= MIN_SHARE and r.steadiness >= MIN_STEADINESS]
    return max(good, key=lambda r: r.steadiness + r.share) if good else None


def _rated(seen: WorldNormals, candidate: Array) -> UpInWorld:
    """The candidate moved to the mean of the normals about it, with its support."""
    up = candidate
    for tolerance in (WIDE_RAD, MIDDLE_RAD, MIDDLE_RAD):
        near = seen.normal[np.abs(seen.normal @ up) > np.cos(tolerance)]
        if not len(near):
            return UpInWorld(candidate, 0.0, 0.0)
        up = mean_axis(near, up)
    share = float((np.abs(seen.normal @ up) > np.cos(MIDDLE_RAD)).mean())
    cosine = np.percentile(seen.image_up @ up, STEADY_PERCENTILE, axis=0) - [0.0, LANDSCAPE_BONUS, LANDSCAPE_BONUS]
    return UpInWorld(up, share, float(cosine.max()))
