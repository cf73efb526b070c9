"""Rotations and angles; numpy only. Quaternions are (x, y, z, w); rotations are named `to_from`."""

import numpy as np

from floorplan.model.checks import Array


def rotation_from_quat_xyzw(quat_xyzw: Array) -> Array:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4), which are normalised first."""
    q = np.asarray(quat_xyzw, dtype=np.float64)
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    x, y, z, w = np.moveaxis(q, -1, 0)
    rows = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def quat_xyzw_from_rotation(rotation: Array) -> Array:
    """Unit quaternions (..., 4) with w >= 0 of rotation matrices (..., 3, 3) (Bar-Itzhack's eigenvector form, exact everywhere)."""
    r = np.asarray(rotation, dtype=np.float64)
    k = np.empty((*r.shape[:-2], 4, 4))
    for i in range(3):
        for j in range(3):
            k[..., i, j] = r[..., i, j] + r[..., j, i]
        k[..., i, i] -= np.trace(r, axis1=-2, axis2=-1)
    vector = np.stack((r[..., 2, 1] - r[..., 1, 2], r[..., 0, 2] - r[..., 2, 0], r[..., 1, 0] - r[..., 0, 1]), axis=-1)
    k[..., :3, 3] = k[..., 3, :3] = vector
    k[..., 3, 3] = np.trace(r, axis1=-2, axis2=-1)
    q = np.linalg.eigh(k)[1][..., -1]
    return np.asarray(np.where(q[..., 3:] < 0, -q, q))


def rotation_about_z(angle_rad: Array) -> Array:
    """Rotation matrices (..., 3, 3) by `angle_rad` (...) counter-clockwise about z."""
    angle = np.asarray(angle_rad, dtype=np.float64)
    cosine, sine = np.cos(angle), np.sin(angle)
    rotation = np.zeros((*angle.shape, 3, 3))
    rotation[..., 0, 0], rotation[..., 0, 1] = cosine, -sine
    rotation[..., 1, 0], rotation[..., 1, 1] = sine, cosine
    rotation[..., 2, 2] = 1.0
    return rotation


def level_from_sensor(down_sensor: Array, odom_from_sensor: Array, up_odom: Array) -> Array:
    """Rotations (N, 3, 3) that level each frame and keep the odometry's heading.

    The result takes `down_sensor (N, 3)` to (0, 0, -1) exactly; its heading about z is the one the odometry gives in a
    world levelled once by `up_odom (3,)`, so that the Manhattan yaw relative to it changes only as the odometry drifts.
    """
    level_from_odom = rotation_between(up_odom, np.array([0.0, 0.0, 1.0]))
    rough = level_from_odom @ np.asarray(odom_from_sensor)
    up_rough = -np.einsum("nij,nj->ni", rough, np.asarray(down_sensor))
    return np.asarray(rotation_between(up_rough, np.array([0.0, 0.0, 1.0])) @ rough)


def rotation_between(source: Array, target: Array) -> Array:
    """The smallest rotations (..., 3, 3) that take vectors `source (..., 3)` to the direction of `target (3,)`."""
    a, b = np.asarray(source, dtype=np.float64), np.asarray(target, dtype=np.float64)
    a, b = a / np.linalg.norm(a, axis=-1, keepdims=True), b / np.linalg.norm(b)
    cosine = (a @ b)[..., None, None]
    opposite = cosine < -1 + 1e-12
    x, y, z = np.moveaxis(np.cross(a, b), -1, 0)
    zero = np.zeros_like(x)
    rows = ((zero, -z, y), (z, zero, -x), (-y, x, zero))
    skew = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    turn = np.eye(3) + skew + skew @ skew / np.where(opposite, 1.0, 1 + cosine)
    return np.asarray(np.where(opposite, _half_turns(a), turn) if opposite.any() else turn)


def _half_turns(direction: Array) -> Array:
    """Half turns (..., 3, 3) about any axis perpendicular to `direction (..., 3)`."""
    normal = np.cross(direction, np.eye(3)[np.abs(direction).argmin(axis=-1)])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.asarray(2 * normal[..., :, None] * normal[..., None, :] - np.eye(3))


def wrap_to(angle_rad: Array, period_rad: float) -> Array:
    """Angles folded to [-period / 2, period / 2)."""
    half = period_rad / 2
    return np.asarray((np.asarray(angle_rad) + half) % period_rad - half)


def rotation_from_vector(vector_rad: Array) -> Array:
    """Rotation matrices (..., 3, 3) about `vector_rad (..., 3)` by its length (Rodrigues)."""
    vector = np.asarray(vector_rad, dtype=np.float64)
    half = np.linalg.norm(vector, axis=-1, keepdims=True) / 2
    return rotation_from_quat_xyzw(np.concatenate((0.5 * np.sinc(half / np.pi) * vector, np.cos(half)), axis=-1))


def vector_from_rotation(rotation: Array) -> Array:
    """Rotation vectors (..., 3), of length at most pi, of rotation matrices (..., 3, 3)."""
    quat = quat_xyzw_from_rotation(rotation)
    sine = np.linalg.norm(quat[..., :3], axis=-1, keepdims=True)
    angle = 2 * np.arctan2(sine, quat[..., 3:])
    tiny = sine < np.finfo(np.float64).tiny
    return np.asarray(quat[..., :3] * np.divide(angle, sine, out=np.full_like(sine, 2.0), where=~tiny))
