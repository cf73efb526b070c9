"""The scene in an Open3D window."""

from typing import Any

import numpy as np

from floorplan.errors import UsageError
from floorplan.open3d_library import load_open3d
from floorplan.view.scene import Line3D, Scene3D, sampled

DASH_M = 0.06  # length of a plane's dots
POINT_PIXELS = 2.0


def show(scene: Scene3D, title: str) -> None:
    """Open a window and wait until it is closed. Raises UsageError where none can be opened.

    The caller knows whether there is a screen: without one, Open3D may draw where nobody looks and wait for ever.
    """
    open3d = load_open3d()
    window = open3d.visualization.Visualizer()
    if not window.create_window(window_name=title):
        raise UsageError("there is no screen to open a window on; 'floorplan view WORK --screenshot F.png' makes a picture instead")
    window.get_render_option().point_size = POINT_PIXELS
    window.add_geometry(_cloud(open3d, scene.points_m, scene.colours))
    for line in scene.lines:
        window.add_geometry(_line(open3d, line))
    window.run()
    window.destroy_window()


def _cloud(open3d: Any, points_m: Any, colours: Any) -> Any:
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(np.array(points_m)))
    cloud.colors = open3d.utility.Vector3dVector(colours / 255.0)
    return cloud


def _line(open3d: Any, line: Line3D) -> Any:
    """A path as connected lines; a plane's outline as dots."""
    if line.dotted:
        points = sampled(line.points_m, DASH_M, dotted=True)
        return _cloud(open3d, points, np.tile(np.array(line.colour), (len(points), 1)))
    steps = np.arange(len(line.points_m) - 1)
    lines = open3d.geometry.LineSet(
        open3d.utility.Vector3dVector(np.array(line.points_m)), open3d.utility.Vector2iVector(np.stack((steps, steps + 1), axis=1))
    )  # copies: Open3D wants arrays it could write to
    lines.paint_uniform_color(np.array(line.colour) / 255.0)
    return lines
