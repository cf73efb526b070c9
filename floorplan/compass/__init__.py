"""The compass: the Manhattan yaw of every keyframe relative to the odometry's heading.

`survey` looks at the recording once, sparsely, and gives every keyframe a prior yaw, so that the main pass can take the
frames in any order. `method = "moments"` finds it from surface normals, over past and future; `"entropy"` is the
published sequential search.
"""

from floorplan.compass.prior import CompassPrior, heading_walk
from floorplan.compass.survey import survey

__all__ = ["CompassPrior", "heading_walk", "survey"]
