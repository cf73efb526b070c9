"""Wheels of the simulation: slips are few, large, and all that comes after carries them."""

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.simulate.odometry import Odometry
from floorplan.simulate.wheels import SLIP_EVERY_M, slipping


def test_wheels_slip_every_twenty_metres_by_decimetres_and_degrees_and_steps_between_stay() -> None:
    count = 8001
    straight = Odometry(np.column_stack((0.05 * np.arange(count), np.zeros((count, 2)))), rotation_about_z(np.zeros(count)))
    found = slipping(straight, 4)
    yaw = np.arctan2(found.odom_from_camera[:, 1, 0], found.odom_from_camera[:, 0, 0])
    turned = np.degrees(np.abs(np.diff(np.unwrap(yaw))))
    slips = np.flatnonzero(turned > 1e-6)
    expected = 400.0 / SLIP_EVERY_M
    assert 0.5 * expected < len(slips) < 1.7 * expected
    assert 1.0 < np.median(turned[slips]) < 8.0
    step = np.linalg.norm(np.diff(found.position_m, axis=0), axis=1)
    np.testing.assert_allclose(np.delete(step, slips), 0.05, atol=1e-9)
    assert 0.05 < np.median(step[slips]) < 0.4
    np.testing.assert_array_equal(slipping(straight, 4).position_m, found.position_m)
    assert np.abs(slipping(straight, 5).position_m - found.position_m).max() > 0.1
