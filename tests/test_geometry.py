"""Rotations between directions, many at once."""

import numpy as np

from floorplan.geometry import level_from_sensor, rotation_between


def test_each_rotation_takes_its_vector_to_the_target_by_the_smallest_angle() -> None:
    source = np.random.default_rng(0).normal(size=(200, 3))
    source[0], source[1] = (0.0, 0.0, -2.0), (0.0, 0.0, 0.5)  # opposite, and there already
    target = np.array([0.0, 0.0, 1.0])
    turn = rotation_between(source, target)
    unit = source / np.linalg.norm(source, axis=1, keepdims=True)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", turn, unit), np.tile(target, (200, 1)), atol=1e-12)
    np.testing.assert_allclose(turn @ np.swapaxes(turn, 1, 2), np.tile(np.eye(3), (200, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(turn), 1.0)
    np.testing.assert_allclose((np.trace(turn, axis1=1, axis2=2) - 1) / 2, unit @ target, atol=1e-12)  # its angle is the one between them


def test_one_vector_gives_one_rotation_and_frames_are_levelled_exactly() -> None:
    assert rotation_between(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])).shape == (3, 3)
    down = np.random.default_rng(1).normal(size=(5, 3))
    down /= np.linalg.norm(down, axis=1, keepdims=True)
    level = level_from_sensor(down, np.tile(np.eye(3), (5, 1, 1)), np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(np.einsum("nij,nj->ni", level, down), np.tile((0.0, 0.0, -1.0), (5, 1)), atol=1e-12)
