"""A survey in three dimensions: depth points by the axis of their surface, planes, the path before and after."""

from floorplan.view.picture import scene_picture
from floorplan.view.scene import Scene3D, make_scene
from floorplan.view.window import show

__all__ = ["Scene3D", "make_scene", "scene_picture", "show"]
