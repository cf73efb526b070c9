"""A made-up floor as surveys: rooms of known walls, seen in part, in any plan frame."""

import numpy as np

from floorplan.several.survey import Survey

ROOMS = (
    (0.0, 0.0, 4.0, 3.0),
    (4.2, 0.0, 9.0, 3.0),
    (0.0, 3.2, 9.0, 5.0),
    (9.2, 0.0, 12.1, 5.0),
    (0.0, 5.2, 3.3, 9.9),
    (3.5, 5.2, 12.1, 8.8),
)


def floor_survey(rooms: tuple[tuple[float, float, float, float], ...]) -> Survey:
    """All four walls of each room (x0, y0, x1, y1), and its inside free."""
    axis, facing, offset, reach, free = [], [], [], [], []
    for x0, y0, x1, y1 in rooms:
        for a, f, at, along in ((0, 1, x0, (y0, y1)), (0, -1, x1, (y0, y1)), (1, 1, y0, (x0, x1)), (1, -1, y1, (x0, x1))):
            axis.append(a)
            facing.append(f)
            offset.append(at)
            reach.append(along)
        x, y = np.meshgrid(np.arange(x0 + 0.03, x1, 0.05), np.arange(y0 + 0.03, y1, 0.05), indexing="ij")
        free.append(np.column_stack((x.ravel(), y.ravel())))
    first = np.array([(rooms[0][0] + rooms[0][2]) / 2, (rooms[0][1] + rooms[0][3]) / 2])
    return Survey(np.array(axis), np.array(facing), np.array(offset), np.array(reach), np.concatenate(free), first, True)
