"""The parts of a segment's error: the lean that noise along the rays gives, sizes learnt from double differences, bent surfaces."""

import numpy as np
import pytest

from floorplan.compass.smoothing import smooth_angle
from floorplan.geometry import rotation_about_z
from floorplan.grid.normals import NoiseScale, pixel_weights, surface_normals
from floorplan.model.scan import Intrinsics, NoiseModel, Sensor, SensorKind
from floorplan.model.segment import Segments
from floorplan.segments.chunk import join_patches
from floorplan.segments.chunk_evidence import joined_evidence, points_at_hand
from floorplan.segments.error_sizes import SegmentErrors, learnt_sizes
from floorplan.segments.fit import Column, fit_components
from floorplan.segments.ripple import Ripple, ripple_of
from floorplan.segments.rotation import corrections
from floorplan.segments.surfaces import surface_of_segment
from floorplan.segments.values import SegmentedChunk

NOISE = NoiseModel(0.002, 0.0, 0.003)  # 3 cm at 3 m: structured light
FRAMES = 240


def rays() -> np.ndarray:
    u, v = np.meshgrid((np.arange(160) - 79.5) / 150.0, (np.arange(100) - 49.5) / 150.0)
    ray = np.stack((u, v, np.ones_like(u)), axis=-1)
    return np.asarray(ray / np.linalg.norm(ray, axis=-1, keepdims=True))


def oblique_wall(random: np.random.Generator) -> np.ndarray:
    """Points of a wall 3 m away, seen at 40 degrees to its normal, noise along the rays."""
    normal = np.array((np.sin(np.radians(40.0)), 0.0, np.cos(np.radians(40.0))))
    reach = 3.0 / (rays() @ normal)
    noisy = reach + random.normal(size=reach.shape) * NOISE.sigma_m(reach)
    return np.asarray((rays() * noisy[..., None]).astype(np.float32))


def fit_of(points: np.ndarray, noise_m: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The fit of all points as one component normal to the first row of the rotation, and that rotation."""
    angle = np.radians(40.0)
    rotation = np.array(((np.sin(angle), 0.0, np.cos(angle)), (np.cos(angle), 0.0, -np.sin(angle)), (0.0, 1.0, 0.0)))
    pixels = np.arange(points[..., 0].size)
    bounds = np.array((0, len(pixels)))
    weight = np.ones(points.shape[:2], np.float32)
    fits, _ = fit_components(points, weight, noise_m, np.zeros(1, np.int64), bounds, pixels, rotation, False)
    return fits[0], rotation


def slope_along(row: np.ndarray, rotation: np.ndarray) -> float:
    xx, xy, xz, yy, yz, zz = row[Column.SCATTER : Column.SCATTER + 6]
    scatter = np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))
    return float(rotation[0] @ scatter @ rotation[1] / (rotation[1] @ scatter @ rotation[1]))


def test_noise_along_the_rays_does_not_lean_a_wall_seen_at_an_angle() -> None:
    slopes, naive = [], []
    for seed in range(30):
        points = oblique_wall(np.random.default_rng(seed))
        noise_m = NOISE.sigma_m(3.0 / (rays() @ np.array((np.sin(np.radians(40.0)), 0.0, np.cos(np.radians(40.0))))))
        row, rotation = fit_of(points, noise_m.astype(np.float32))
        slopes.append(slope_along(row, rotation))
        world = points.reshape(-1, 3) @ rotation.T
        off = world - world.mean(axis=0)
        naive.append((off[:, 0] * off[:, 1]).sum() / (off[:, 1] ** 2).sum())
    assert abs(np.mean(naive)) > 5e-4
    assert abs(np.mean(slopes)) < 1.5e-4


def test_a_plane_far_away_is_not_drawn_nearer_by_readings_that_are_too_near_by_chance() -> None:
    sensor = Sensor(SensorKind.CAMERA, 100, 160, NOISE, 0.2, 9.0, 1 / 150.0, Intrinsics(160, 100, 150.0, 150.0, 79.5, 49.5))
    reach = 4.0 / rays()[..., 2]
    error, by_own_range = [], []
    for seed in range(20):
        noisy = reach + np.random.default_rng(seed).normal(size=reach.shape) * NOISE.sigma_m(reach)
        points = (rays() * noisy[..., None]).astype(np.float32)
        found = surface_normals(points, pixel_weights(points, None), sensor, NoiseScale(), 0.2, np.radians(2.5))
        for sigma, errors in ((found.noise_m, error), (NOISE.sigma_m(noisy), by_own_range)):
            errors.append((points[..., 2] * sigma**-2.0).sum() / (sigma**-2.0).sum() - 4.0)
    assert np.mean(by_own_range) < -2e-3
    assert abs(np.mean(error)) < 5e-4


def walk(noise_m: float, turn_rad: float, hidden_m: float, seed: int) -> tuple[Segments, SegmentErrors, np.ndarray, np.ndarray]:
    """A corridor seen from many places: both walls in every keyframe, each one near or far ahead; errors drawn with the given sizes."""
    random = np.random.default_rng(seed)
    position = np.stack((0.3 * np.arange(FRAMES), 0.3 * np.sin(np.arange(FRAMES) / 9.0), np.zeros(FRAMES)), axis=1)
    frame = np.repeat(np.arange(FRAMES), 2)
    wall = np.tile((1.0, -1.0), FRAMES)
    ahead = random.uniform(0.5, 4.0, size=2 * FRAMES)
    stated = random.choice((0.0005, 0.001, 0.004), size=2 * FRAMES)
    turned = turn_rad * random.normal(size=FRAMES)
    distance = wall - position[frame, 1] + ahead * turned[frame]
    distance += noise_m * stated * random.normal(size=2 * FRAMES) + hidden_m * random.normal(size=2 * FRAMES)
    zero = np.zeros(2 * FRAMES)
    extent = np.stack((np.stack((ahead - 4, distance - 0.01, zero - 1), 1), np.stack((ahead + 4, distance + 0.01, zero + 1), 1)), axis=2)
    eye = np.tile(np.eye(3), (2 * FRAMES, 1, 1))
    ones = np.ones(2 * FRAMES)
    segments = Segments(frame, ones, -np.sign(distance), distance, stated, 900 * ones, ones, extent, np.zeros((2 * FRAMES, 3)), eye)
    lever = np.stack((zero, zero, ahead * 0.002), axis=1)
    return segments, SegmentErrors(stated, lever), position, np.diff(position, axis=0)


@pytest.mark.parametrize(("noise", "turn", "hidden"), [(1.0, 1.0, 0.0), (2.0, 0.7, 0.003), (1.0, 1.5, 0.006)])
def test_the_sizes_of_errors_are_learnt_from_what_two_surfaces_are_apart(noise: float, turn: float, hidden: float) -> None:
    found = []
    for seed in range(8):
        segments, errors, position, step = walk(noise, turn * 0.002, hidden, seed)
        sizes = learnt_sizes(segments, surface_of_segment(segments, step), errors, position, np.tile(np.eye(3), (FRAMES, 1, 1)))
        assert sizes is not None
        found.append(((sizes.noise * 0.0023) ** 2 + (sizes.turn * 0.004) ** 2 + sizes.hidden_m**2, sizes.hidden_m))
    expected = (noise * 0.0023) ** 2 + (turn * 0.004) ** 2 + hidden**2
    assert np.mean([total for total, _ in found]) == pytest.approx(expected, rel=0.25)
    assert np.mean([part for _, part in found]) == pytest.approx(hidden, abs=0.0015)


def test_a_recording_with_one_wall_at_a_time_says_nothing_about_its_errors() -> None:
    segments, errors, position, step = walk(1.0, 0.002, 0.0, 1)
    alone = np.arange(0, len(segments), 2)
    single = Segments(*(getattr(segments, name)[alone] for name in Segments.__dataclass_fields__))
    few = SegmentErrors(errors.noise_m[alone], errors.lever_m[alone])
    assert learnt_sizes(single, surface_of_segment(single, step), few, position, np.tile(np.eye(3), (FRAMES, 1, 1))) is None


def test_surfaces_are_followed_and_walls_that_face_each_other_are_two() -> None:
    segments, _, _, step = walk(1.0, 0.0, 0.0, 3)
    surface = surface_of_segment(segments, step)
    assert len(set(surface[0::2])) == len(set(surface[1::2])) == 1
    assert surface[0] != surface[1]


def test_a_surface_bent_out_of_the_ordinary_hardly_turns_its_frame() -> None:
    zero, one = np.zeros(2), np.ones(2)
    scatter = np.diag((1e-6, 0.5, 0.5))
    leaning = rotation_about_z(np.array(0.01)) @ scatter @ rotation_about_z(np.array(0.01)).T
    scatters = np.stack((scatter, leaning))
    centroid = np.tile((2.0, 0.0, 0.0), (2, 1))
    segments = Segments(zero, zero, -one, 2 * one, 0.001 * one, 5000 * one, one, np.zeros((2, 3, 2)), centroid, scatters)
    yaw = [corrections(segments, np.eye(3)[None], Ripple(0.0, np.array((0.0, own)))).delta_rad[0, 2] for own in (0.0, 0.005)]
    assert abs(yaw[0]) > 0.002
    assert abs(yaw[1]) < 0.001


def test_a_heading_that_trembles_is_the_odometrys_and_good_readings_are_followed() -> None:
    random = np.random.default_rng(5)
    truth = np.cumsum(random.normal(scale=1e-5, size=500)) + random.normal(scale=0.001, size=500)
    reading = truth + random.normal(scale=0.0002, size=500)
    smooth = smooth_angle(reading, np.full(500, 0.0002), np.ones(499), slips=True, most_scale=1.0)
    assert np.sqrt(((smooth.angle_rad - truth) ** 2).mean()) < 0.0003


def test_readings_are_as_sure_as_they_say_where_the_heading_wanders_more_than_they_err() -> None:
    random = np.random.default_rng(9)
    sigma, count = 0.0001, 24
    heading = np.cumsum(random.normal(size=count) * 0.0015)  # far more than the readings' noise from one to the next
    smooth = smooth_angle(
        heading + random.normal(size=count) * sigma, np.full(count, sigma), np.ones(count - 1), slips=True, most_scale=1.0, white_scale=0.7
    )
    z = (smooth.angle_rad - heading) / smooth.sigma_rad
    assert 0.6 < np.sqrt((z**2).mean()) < 1.6


def test_a_ripple_that_white_noise_alone_makes_is_no_second_surface() -> None:
    blocks, white_m2, rows = 40, 1.6e-6, 500
    by_chance = np.sqrt(2 / blocks) * white_m2 * np.random.default_rng(5).normal(size=rows)
    ripple_m2 = np.r_[by_chance, 0.003**2]
    own_m = own_ripple_m(ripple_m2, np.full(rows + 1, blocks), np.sqrt((white_m2 + ripple_m2) / blocks))
    assert 0.002 < own_m[-1] < 0.0031
    assert 0 < np.count_nonzero(own_m[:-1]) < 0.06 * rows


def own_ripple_m(ripple_m2: np.ndarray, blocks: np.ndarray, sigma_m: np.ndarray) -> np.ndarray:
    """Of one keyframe's segments of the given ripple."""
    count = len(blocks)
    row, box, point, scatter = np.zeros(count), np.zeros((count, 3, 2)), np.zeros((count, 3)), np.zeros((count, 3, 3))
    segments = Segments(row, row, row + 1, row, sigma_m, row, row, box, point, scatter)
    nothing = joined_evidence([], 0, points_at_hand)
    chunk = SegmentedChunk(np.zeros(1), np.eye(3)[None], np.zeros(1), np.ones(1), segments, ripple_m2, blocks, join_patches([]), nothing)
    return np.asarray(ripple_of([chunk]).own_m)
