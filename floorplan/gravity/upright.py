"""The vertical in one frame, from floors, ceilings and walls together.

Depth whose error grows with the square of range lifts a floor and lowers a ceiling with distance: both tilt, by a degree
and more, in opposite ways. Upright walls do not lean from it. So each kind of surface has a systematic error of its own,
and the vertical is their weighted mean.
"""

import numpy as np

from floorplan.gravity.horizontal import UpInFrame, up_in_frame
from floorplan.gravity.normals import OrientedPoints
from floorplan.model.checks import Array
from floorplan.model.scan import NoiseModel

UPRIGHT_RAD = np.deg2rad(8.0)  # a normal so close to level belongs to a wall
ROBUST_RAD = np.deg2rad(2.5)  # noise of one normal; chairs and people beyond it count little
WALL_SIGMA_RAD = np.deg2rad(0.5)  # systematic, in the direction a wall faces
HORIZONTAL_SIGMA_RAD = np.deg2rad(1.5)  # systematic: what such depth errors do to a floor 1.4 m below the sensor
FULL_POINTS = 75.0  # fewer wall points of one direction on the thinned grid are trusted less
ROUNDS = 8
MAX_SIGMA_RAD = np.deg2rad(2.0)  # a worse one is no measurement


def up_of_frame(oriented: OrientedPoints, predicted_up: Array, noise: NoiseModel) -> UpInFrame | None:
    """The vertical near `predicted_up (3,)`, sensor axes; None when neither horizontal surfaces nor walls of two directions show it.

    `sigma_rad` is that of the worse direction.
    """
    horizontal = up_in_frame(oriented, predicted_up, noise)
    start = horizontal.up_sensor if horizontal else predicted_up
    across = _level_axes(start)
    walls = oriented.where(np.abs(oriented.normal @ start) < np.sin(UPRIGHT_RAD)).normal.astype(np.float64)
    slope, lean = walls @ across.T, walls @ start
    known = np.eye(2) / HORIZONTAL_SIGMA_RAD**2 if horizontal else np.zeros((2, 2))
    tilt, information = np.zeros(2), known
    for _ in range(ROUNDS if len(walls) else 0):  # a wall's normal n with up = start + tilt: n.start + n.tilt = 0
        weight = 1.0 / (1.0 + ((lean + slope @ tilt) / ROBUST_RAD) ** 2)
        seen, direction = np.linalg.eigh((slope * weight[:, None]).T @ slope)
        wanted = -direction.T @ (slope * weight[:, None]).T @ lean / np.maximum(seen, 1e-9)
        trusted = np.minimum(seen / FULL_POINTS, 1.0) / WALL_SIGMA_RAD**2  # more points do not mend a systematic error
        information = known + (direction * trusted) @ direction.T
        tilt = np.linalg.lstsq(information, direction @ (trusted * wanted), rcond=None)[0]
    weakest = float(np.linalg.eigvalsh(information)[0])
    if weakest < MAX_SIGMA_RAD**-2:
        return None
    up = start + tilt @ across
    return UpInFrame(up / np.linalg.norm(up), weakest**-0.5)


def _level_axes(up: Array) -> Array:
    """Two unit vectors (2, 3) that span the level plane."""
    first = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(up, first)])
