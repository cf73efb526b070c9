"""A corridor building of axis-aligned planes and a walk through it: the ground under the back end's scenes."""

from dataclasses import dataclass

import numpy as np

CORRIDOR_WIDTH_M = 2.0
EYE_HEIGHT_M = 1.4
FRAME_SPACING_M = 0.10  # keyframes of a walked scan
VIEW_NEAR_M, VIEW_FAR_M = 0.3, 6.0  # range of the paper's depth camera
VIEW_AHEAD_M = 4.0  # side walls are seen from beside the camera to this far ahead
STOREY_M = 3.6
STAIR_M = 12.0  # walked length of a stair, on which no floor or ceiling is followed


@dataclass(frozen=True)
class Planes:
    """True planes: `axis (P,)`, `facing (P,)`, `offset_m (P,)`, `extent_m (P, 3, 2)`."""

    axis: np.ndarray
    facing: np.ndarray
    offset_m: np.ndarray
    extent_m: np.ndarray


@dataclass(frozen=True)
class Walk:
    """Sensor positions (N, 3), metres, and the unit direction of walking (N, 3)."""

    position_m: np.ndarray
    heading: np.ndarray


@dataclass(frozen=True)
class Ring:
    """A ring corridor: centre line from `corner_m` over `size_m` (x, y), floor at `floor_m`."""

    corner_m: tuple[float, float]
    size_m: tuple[float, float]
    floor_m: float


def ring_planes(ring: Ring, extra: int, close: bool, rng: np.random.Generator) -> Planes:
    """Eight walls, floor and ceiling, and `extra` parallel planes beside walls: niches, pillars, rooms, lowered ceilings.

    `close`: all extras lie 10-40 cm from their wall, the case that a fixed threshold merges wrongly.
    """
    half, low = CORRIDOR_WIDTH_M / 2, np.array(ring.corner_m)
    high, height = low + np.array(ring.size_m), (ring.floor_m, ring.floor_m + 2.7)
    rows = []
    for axis in (0, 1):
        other = 1 - axis
        for line, outward in ((low[axis], -1), (high[axis], 1)):
            for side, reach in ((outward, half), (-outward, -half)):
                extent = np.empty((3, 2))
                extent[other] = low[other] - reach, high[other] + reach
                extent[2] = height
                rows.append((axis, -side, line + side * half, extent))
    walls = list(rows)
    for facing, level in ((1, height[0]), (-1, height[1])):
        extent = np.array([[low[0] - half, high[0] + half], [low[1] - half, high[1] + half], [0.0, 0.0]])
        rows.append((2, facing, level, extent))
    rows += [_beside(walls[rng.integers(len(walls))], close, rng) for _ in range(extra)]
    planes = Planes(*(np.array(column) for column in zip(*rows, strict=True)))
    planes.extent_m[np.arange(len(rows)), planes.axis] = planes.offset_m[:, None]
    return planes


def _beside(wall: tuple[int, int, float, np.ndarray], close: bool, rng: np.random.Generator) -> tuple[int, int, float, np.ndarray]:
    """A plane of the same facing before or behind a stretch of a wall."""
    axis, facing, offset, extent = wall
    kind = rng.random()
    if close or kind < 0.4:
        shift, length = rng.choice([-1, 1]) * rng.uniform(0.10, 0.40), rng.uniform(1.5, 5.0)
    elif kind < 0.7:
        shift, length = rng.uniform(0.5, 1.5), rng.uniform(1.5, 4.0)
    else:
        shift, length = rng.uniform(3.0, 4.5), rng.uniform(3.0, 6.0)
    other = 1 - axis
    along = extent.copy()
    start = rng.uniform(extent[other, 0], max(extent[other, 1] - length, extent[other, 0] + 0.1))
    along[other] = start, start + length
    return axis, facing, offset - facing * shift, along


def ring_walk(ring: Ring, laps: int) -> np.ndarray:
    """Corners of a walk `laps` times about the ring, from the middle of its first side and back to it, (C, 3)."""
    (x, y), (width, depth), z = ring.corner_m, ring.size_m, ring.floor_m + EYE_HEIGHT_M
    start = (x + width / 2, y, z)
    lap = [(x + width, y, z), (x + width, y + depth, z), (x, y + depth, z), (x, y, z), start]
    return np.array([start, *lap * laps])


def walk_along(corners_m: np.ndarray, rng: np.random.Generator) -> Walk:
    """Positions every `FRAME_SPACING_M` along straight lines between corners, swaying a little as people do."""
    length = np.linalg.norm(np.diff(corners_m, axis=0), axis=1)
    at = np.concatenate(([0], np.cumsum(length)))
    along = np.linspace(0, at[-1], round(at[-1] / FRAME_SPACING_M) + 1)
    position = np.stack([np.interp(along, at, corners_m[:, k]) for k in range(3)], axis=1)
    leg = np.clip(np.searchsorted(at, along, side="right") - 1, 0, len(length) - 1)
    heading = (np.diff(corners_m, axis=0) / length[:, None])[leg]
    phase, sway = rng.uniform(0, 2 * np.pi, 3), np.array([0.08, 0.08, 0.02])
    wave = sway * np.sin(2 * np.pi * along[:, None] / np.array([4.1, 5.3, 0.75]) + phase)
    fade = np.minimum(1, np.minimum(along, at[-1] - along) / 2.0)[:, None]  # start and end are the same place
    return Walk(position + wave * fade, heading)


def visible_patch(planes: Planes, plane: int, walk: Walk) -> tuple[np.ndarray, np.ndarray]:
    """Which frames see a plane (N,), and the part of its box that each sees (N, 3, 2)."""
    axis, facing, offset = int(planes.axis[plane]), planes.facing[plane], planes.offset_m[plane]
    distance = offset - walk.position_m[:, axis]
    ahead = distance * walk.heading[:, axis]
    seen = (-facing * distance > VIEW_NEAR_M) & (np.abs(distance) < VIEW_FAR_M)
    upright_walls_behind = (np.abs(walk.heading[:, axis]) > 0.5) & (ahead < 0)
    seen &= ~upright_walls_behind
    seen &= np.abs(walk.heading[:, 2]) < 0.05  # nothing is followed on stairs
    reach = VIEW_AHEAD_M * walk.heading
    low, high = walk.position_m + np.minimum(reach, 0) - 1.0, walk.position_m + np.maximum(reach, 0) + 1.0
    part = np.stack((np.maximum(low, planes.extent_m[plane, :, 0]), np.minimum(high, planes.extent_m[plane, :, 1])), axis=2)
    part[:, axis] = offset
    lateral = [k for k in range(3) if k != axis]
    seen &= ((part[:, lateral, 1] - part[:, lateral, 0]) > 0.3).all(axis=1)
    return seen, part
