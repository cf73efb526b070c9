"""The down direction of recordings that have neither an accelerometer nor a gravity-aligned world.

up            the unit vector against gravity, in the sensor's axes or the odometry's world
horizontal    a surface whose normal lies near the vertical: floors, ceilings, tables
The direction is first sought for the whole recording (`search`), then measured in every looked-at frame (`horizontal`)
and smoothed along the odometry (`smoothing`), because odometry may bend by several degrees.
"""

from floorplan.gravity.estimate import estimate_gravity

__all__ = ["estimate_gravity"]
