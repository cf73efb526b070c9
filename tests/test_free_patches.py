"""Lines off the axes: fitted to all of their surface, not to the part whose normals lean furthest."""

import numpy as np
import pytest

from floorplan.grid.components import connected_components
from floorplan.grid.normals import NoiseScale, surface_normals
from floorplan.model.scan import Intrinsics, NoiseModel, Sensor, SensorKind
from floorplan.segments.free_patches import off_axis_patches
from floorplan.segments.labels import label_by_normals

NOISE = NoiseModel(0.006, 0.004)
SENSOR = Sensor(SensorKind.CAMERA, 120, 160, NOISE, 0.2, 6.5, 1 / 140.0, Intrinsics(160, 120, 140.0, 140.0, 79.5, 59.5))
TOLERANCE_RAD = np.radians(5.0)
AHEAD_M = 2.0


def bent_wall(off_deg: float, seed: int) -> np.ndarray:
    """A wall ahead whose normal is `off_deg` off the axis, with noise and a ripple as phones have: its normals vary by degrees."""
    u, v = np.meshgrid((np.arange(160) - 79.5) / 140.0, (np.arange(120) - 59.5) / 140.0)
    rays = np.stack((u, v, np.ones_like(u)), axis=-1)
    normal = np.array((np.sin(np.radians(off_deg)), 0.0, np.cos(np.radians(off_deg))))
    depth = AHEAD_M / (rays @ normal)
    depth += 0.008 * np.sin(2 * np.pi * u / 0.35) + np.random.default_rng(seed).normal(size=depth.shape) * 0.004
    return np.asarray((rays * depth[..., None]).astype(np.float32))


def lines(points: np.ndarray) -> np.ndarray:
    world_from_sensor = np.array(((0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)))
    weight = np.ones(points.shape[:2], np.float32)
    normals = surface_normals(points, weight, SENSOR, NoiseScale(), 0.15, np.radians(2.5))
    labels = label_by_normals(points, normals, world_from_sensor, TOLERANCE_RAD)
    components = connected_components(labels.label, labels.coordinate_m, labels.gate_m, 40)
    return off_axis_patches(components, points, normals, world_from_sensor)


@pytest.mark.parametrize("off_deg", [-11.0, 11.0])
def test_a_wall_at_the_edge_of_the_tolerance_is_drawn_at_its_own_angle(off_deg: float) -> None:
    found = np.concatenate([lines(bent_wall(off_deg, seed)) for seed in range(4)])
    assert len(found) >= 4
    longest = found[np.hypot(found[:, 3] - found[:, 1], found[:, 4] - found[:, 2]) > 0.8]
    yaw_deg = np.degrees(longest[:, 0])
    off = (yaw_deg + 45) % 90 - 45
    assert np.abs(np.abs(off) - 11.0).max() < 0.5
    assert len({float(np.sign(o)) for o in off}) == 1


def test_a_wall_on_an_axis_gives_no_line() -> None:
    assert len(lines(bent_wall(0.0, 1))) == 0
