"""What a click on the plan shows: numbers of a wall, room, opening or dimension, and the frames that saw it."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from floorplan.laser.compare import level_of
from floorplan.model.error_parts import SigmaParts
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Dimension, Opening, Plan, Room
from floorplan.results import Results

SAME_STRETCH = 50  # frames of the recording: a second or two out of sight is still one sighting
SMALLEST_PART_MM = 0.5
Lines = dict[str, list[str]]  # id -> title, then one line per fact: it goes into the page as JSON


def details(results: Results) -> Lines:
    """Id to its lines of text."""
    plan, frames = results.plan, _Frames(results)
    told = {room.id: _room(room) for room in plan.rooms} | {opening.id: _opening(opening) for opening in plan.openings}
    told |= _walls(plan, frames) | {dimension.id: _dimension(dimension, frames) for dimension in plan.dimensions}
    for line in plan.free_lines:
        slant = f"{line.off_axis_deg:.1f}° from the nearest axis, ±{NORMAL_95 * line.sigma_m:.3f} m"
        told[line.id] = [f"Wall off the axes {line.id}", slant]
    told |= {glass.id: [f"Glazing {glass.id}", "rays went through between mullions"] for glass in plan.glazing}
    return told | {column.id: [f"Column {column.id}"] for column in plan.columns}


def _walls(plan: Plan, frames: "_Frames") -> Lines:
    planes_of_face = {face.id: face.plane for face in plan.faces}
    told: Lines = {}
    for wall in plan.walls:
        planes = sorted({planes_of_face[face] for face in wall.faces if face in planes_of_face})
        height = [f"height {wall.height_m:.2f} m"] if wall.height_m else []
        thickness = f"thickness {_pm(wall.thickness_m, wall.thickness_sigma_m)}"
        told[wall.id] = [f"Wall {wall.id}", thickness, *height, *(frames.of(plane) for plane in planes)]
    return told


def _room(room: Room) -> list[str]:
    return [
        f"{room.kind.value.capitalize()} {room.id} {room.name}".strip(),
        f"area {room.area_m2:.2f} m² " + ("of what was seen" if room.partial else f"±{NORMAL_95 * room.area_sigma_m2:.2f}"),
        f"ceiling {_pm(room.ceiling_height_m, room.ceiling_sigma_m)}",
        *([] if room.visited else ["never entered: seen from outside"]),
        *(["not closed by seen walls"] if room.partial else []),
    ]


def _opening(opening: Opening) -> list[str]:
    return [
        f"{opening.kind.value.capitalize()} {opening.id}",
        f"width {_pm(opening.width_m, opening.width_sigma_m)}",
        *([f"head at {opening.head_height_m:.2f} m"] if opening.head_height_m else []),
        "walked through" if opening.walked_through else "not walked through",
    ]


def _dimension(dimension: Dimension, frames: "_Frames") -> list[str]:
    interval = NORMAL_95 * dimension.sigma_m
    return [
        f"Dimension {dimension.id}",
        f"{dimension.distance_m:.3f} m ±{interval:.3f} (95 %), {level_of(interval)}",
        *([_budget(dimension.sigma_parts)] if dimension.sigma_parts else []),
        *([f"in {dimension.room}"] if dimension.room else []),
        *(frames.of(plane) for plane in (dimension.from_plane, dimension.to_plane)),
    ]


def _budget(parts: SigmaParts) -> str:
    """What an interval is made of, each part's own in millimetres, the largest first; parts under half a millimetre are left out."""
    told = [f"{cause.value} {1000 * NORMAL_95 * size:.0f}" for cause, size in parts.by_size if 1000 * NORMAL_95 * size >= SMALLEST_PART_MM]
    return f"made of, in mm, squares adding up: {', '.join(told)}"


class _Frames:
    """Which frames of the recording saw each plane."""

    def __init__(self, results: Results) -> None:
        graph = results.layout.graph
        order = np.argsort(graph.track, kind="stable")
        starts = np.searchsorted(graph.track[order], np.arange(1, len(graph.axis)))
        self.of_track = [results.scan.keyframe[part] for part in np.split(graph.frame[order], starts)]
        self.planes = {plane.id: plane for plane in results.plan.planes}

    def of(self, plane_id: str) -> str:
        """One line about a plane."""
        plane = self.planes[plane_id]
        seen = np.unique(np.concatenate([self.of_track[track] for track in plane.tracks])) if plane.tracks else np.zeros(0, int)
        made = f"{len(plane.tracks)} tracks, {plane.frames} keyframes, frames {_runs(seen.tolist())}"
        return f"{plane_id}: ±{NORMAL_95 * plane.sigma_m:.3f} m, {made}"


def _runs(frames: Sequence[int], most: int = 6) -> str:
    """First and last frame of each stretch of sightings, the first few."""
    if not frames:
        return "none"
    cuts = [0, *(k for k in range(1, len(frames)) if frames[k] - frames[k - 1] > SAME_STRETCH), len(frames)]
    stretches = [f"{frames[a]}-{frames[b - 1]}" for a, b in pairwise(cuts)]
    return ", ".join(stretches[:most]) + (f" and {len(stretches) - most} more" if len(stretches) > most else "")


def _pm(value: float | None, sigma: float | None) -> str:
    if value is None:
        return "not known"
    return f"{value:.3f} m" + ("" if sigma is None else f" ±{NORMAL_95 * sigma:.3f}")
