"""A walk along a route in time: smooth heading with glances to the sides, sway, and true camera poses."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter1d

from floorplan.model.checks import Array, freeze
from floorplan.simulate.route import Route

STEP_M = 0.01  # spacing of the path while it is smoothed
CORNER_SIGMA_M = 0.12  # how far corners are rounded
TURN_SIGMA_M = 0.18  # the body starts to turn this far before a corner
TURN_RATE_RAD_S = np.radians(75.0)
GLANCE_PERIOD_S = 5.0
BOB_M = 0.012  # up and down with every step
STEPS_PER_S = 1.8
FIRST_STAMP_NS = 1_000_000_000_000
# Camera axes (x right, y down, z forward) in body axes (x forward, y left, z up).
BODY_FROM_CAMERA = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True)
class Style:
    """How somebody carries the sensor: angles are standard deviations, in radians."""

    speed_m_s: float
    height_m: float
    glance_rad: float
    pitch_mean_rad: float
    pitch_glance_rad: float
    sway_rad: float


@dataclass(frozen=True)
class Walk:
    """True camera poses of N frames: `stamp_ns (N,)`, `position_m (N, 3)`, `world_from_camera (N, 3, 3)`, `yaw_rad (N,)`."""

    stamp_ns: Array
    position_m: Array
    world_from_camera: Array
    yaw_rad: Array

    def __post_init__(self) -> None:
        layout = {
            "stamp_ns": (np.int64, ("N",)),
            "position_m": (np.float64, ("N", 3)),
            "world_from_camera": (np.float64, ("N", 3, 3)),
            "yaw_rad": (np.float64, ("N",)),
        }
        freeze(self, layout)

    def __len__(self) -> int:
        return len(self.stamp_ns)

    @property
    def path_m(self) -> Array:
        """Distance walked up to each frame (N,), in plan."""
        steps = np.linalg.norm(np.diff(self.position_m[:, :2], axis=0), axis=1)
        return np.concatenate(([0.0], np.cumsum(steps)))


def draw_style(fov_x_deg: float, rng: np.random.Generator) -> Style:
    """A surveyor; a narrow camera is turned about more."""
    narrow = fov_x_deg < 80.0
    return Style(
        speed_m_s=float(rng.uniform(0.8, 1.0)),
        height_m=float(rng.uniform(1.42, 1.58)),
        glance_rad=np.radians(28.0 if narrow else 18.0),
        pitch_mean_rad=np.radians(float(rng.uniform(-4.0, 1.0))),
        pitch_glance_rad=np.radians(9.0 if narrow else 4.0),
        sway_rad=np.radians(1.0),
    )


def walk(route: Route, style: Style, rate_hz: float, rng: np.random.Generator) -> Walk:
    """The route walked at `rate_hz`; the first and the last frame stand at the same place."""
    path_xy, heading, seconds = _timed_path(route, style)
    count = int(seconds[-1] * rate_hz) + 1
    time = np.linspace(0.0, seconds[-1], count)
    xy = np.column_stack([np.interp(time, seconds, path_xy[:, k]) for k in (0, 1)])
    yaw = np.interp(time, seconds, heading) + style.glance_rad * _wander(count, rate_hz, GLANCE_PERIOD_S, rng)
    pitch = style.pitch_mean_rad + style.pitch_glance_rad * _wander(count, rate_hz, GLANCE_PERIOD_S, rng)
    pitch = pitch + style.sway_rad * _wander(count, rate_hz, 0.8, rng)
    roll = style.sway_rad * _wander(count, rate_hz, 0.9, rng)
    bob = BOB_M * np.sin(2 * np.pi * STEPS_PER_S * time) + 0.02 * _wander(count, rate_hz, 8.0, rng)
    bob = bob - np.linspace(bob[0], bob[-1], count)  # back to the height it started at
    position = np.column_stack((xy, style.height_m + bob))
    stamps = FIRST_STAMP_NS + np.round(time * 1e9).astype(np.int64)
    return Walk(stamps, position, rotation_from_yaw_pitch_roll(yaw, pitch, roll) @ BODY_FROM_CAMERA, yaw)


def rotation_from_yaw_pitch_roll(yaw: Array, pitch: Array, roll: Array) -> Array:
    """Rotations (N, 3, 3) world from body: yaw about z, then pitch (up is positive), then roll about the forward axis."""
    zero, one = np.zeros_like(yaw), np.ones_like(yaw)

    def matrix(*rows: tuple[Array, Array, Array]) -> Array:
        return np.stack([np.stack(row, -1) for row in rows], -2)

    cy, sy, cp, sp, cr, sr = np.cos(yaw), np.sin(yaw), np.cos(-pitch), np.sin(-pitch), np.cos(roll), np.sin(roll)
    about_z = matrix((cy, -sy, zero), (sy, cy, zero), (zero, zero, one))
    about_y = matrix((cp, zero, sp), (zero, one, zero), (-sp, zero, cp))
    about_x = matrix((one, zero, zero), (zero, cr, -sr), (zero, sr, cr))
    return about_z @ about_y @ about_x


def _timed_path(route: Route, style: Style) -> tuple[Array, Array, Array]:
    """Dense path (M, 2), heading (M,) unwrapped, and the second (M,) at which each point is reached."""
    stops = np.array([stop.xy for stop in route.stops])
    corner_m = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(stops, axis=0), axis=1))))
    grid = np.linspace(0.0, corner_m[-1], int(corner_m[-1] / STEP_M) + 2)
    dense = np.column_stack([np.interp(grid, corner_m, stops[:, k]) for k in (0, 1)])
    smooth = np.column_stack([_smooth_open(dense[:, k], CORNER_SIGMA_M / STEP_M) for k in (0, 1)])
    direction = np.gradient(dense, axis=0)
    heading = gaussian_filter1d(np.unwrap(np.arctan2(direction[:, 1], direction[:, 0])), TURN_SIGMA_M / STEP_M, mode="nearest")
    for stop, at in zip(route.stops, corner_m, strict=True):
        if stop.spin_rad:
            heading = heading + stop.spin_rad * _ramp(grid, at)
    step_m = np.linalg.norm(np.diff(smooth, axis=0), axis=1)
    step_s = step_m / style.speed_m_s + np.abs(np.diff(heading)) / TURN_RATE_RAD_S
    return smooth, heading, np.concatenate(([0.0], np.cumsum(step_s)))


def _smooth_open(values: Array, sigma: float) -> Array:
    """Gaussian smoothing that keeps both ends where they are (odd reflection)."""
    pad = int(4 * sigma)
    extended = np.pad(values, pad, mode="reflect", reflect_type="odd")
    return np.asarray(gaussian_filter1d(extended, sigma)[pad:-pad])


def _ramp(grid: Array, at: float) -> Array:
    """0 before `at`, 1 after it, within 2 cm."""
    return np.clip((grid - at) / (2 * STEP_M) + 0.5, 0.0, 1.0)


def _wander(count: int, rate_hz: float, period_s: float, rng: np.random.Generator) -> Array:
    """A smooth random signal (count,) of unit standard deviation and about that period."""
    sigma = max(period_s * rate_hz / 6.0, 1.0)
    noise = gaussian_filter1d(rng.standard_normal(count + int(8 * sigma)), sigma)[int(4 * sigma) :][:count]
    return np.asarray(noise * np.sqrt(2 * np.sqrt(np.pi) * sigma))
