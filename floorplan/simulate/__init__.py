"""An exact building, a walked and ray-cast scan of it with a sensor's and an odometry's errors, and its truth."""

from floorplan.simulate.simulate import simulate

__all__ = ["simulate"]
