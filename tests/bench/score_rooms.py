"""Rooms, corridors and doors of a plan against the true ones."""

from typing import Any

import numpy as np
from shapely.geometry import Polygon
from shapely.ops import unary_union

from tests.bench.score_input import Case

MATCH_IOU = 0.5
INSIDE_SHARE = 0.5  # of a drawn room's area: it belongs to the true space that holds that much of it
DOOR_ALONG_M = 0.5
DOOR_ACROSS_M = 0.35
Z95 = 1.96


def room_scores(case: Case) -> dict[str, Any]:
    """IoU and area error of visited rooms, IoU of the corridors, false rooms (in no true space, or a second one in a true room)."""
    true = {space["id"]: Polygon(space["outline"], space["holes"]) for space in case.truth["spaces"]}
    kinds = {space["id"]: space["kind"] for space in case.truth["spaces"]}
    visited = [space["id"] for space in case.truth["spaces"] if space["visited"] and space["kind"] == "room"]
    drawn = [(room, _drawn_polygon(case, room)) for room in case.plan["rooms"]]
    owners = [_owner(shape, true) for _, shape in drawn]
    ious, areas = [], []
    for space_id in visited:
        pairs = [(_iou(shape, true[space_id]), room) for room, shape in drawn]
        iou, room = max(pairs, key=lambda pair: pair[0], default=(0.0, None))
        ious.append(iou)
        if room is not None and iou > MATCH_IOU:
            areas.append(abs(room["area_m2"] - true[space_id].area) / true[space_id].area)
    return {
        "visited": len(visited),
        "room_iou": float(np.mean(ious)) if ious else None,
        "room_iou_worst": min(ious, default=None),
        "corridor_iou": _corridor_iou(true, kinds, [shape for _, shape in drawn], owners),
        "false_rooms": _false_rooms(kinds, [room for room, _ in drawn], owners),
        "area_error": float(np.mean(areas)) if areas else None,
    }


def _drawn_polygon(case: Case, room: dict[str, Any]) -> Polygon:
    return Polygon(case.placement.xy(room["outline"]), [case.placement.xy(hole) for hole in room["holes"]]).buffer(0)


def _owner(shape: Polygon, true: dict[str, Polygon]) -> str | None:
    """The true space that holds more than half of a drawn room."""
    shares = {space_id: shape.intersection(space).area / max(shape.area, 1e-9) for space_id, space in true.items()}
    best = max(shares, key=lambda key: shares[key])
    return best if shares[best] > INSIDE_SHARE else None


def _iou(a: Polygon, b: Polygon) -> float:
    return float(a.intersection(b).area / a.union(b).area)


def _corridor_iou(true: dict[str, Polygon], kinds: dict[str, str], shapes: list[Polygon], owners: list[str | None]) -> float | None:
    corridors = unary_union([shape for space_id, shape in true.items() if kinds[space_id] == "corridor"])
    drawn = [shape for shape, owner in zip(shapes, owners, strict=True) if owner is not None and kinds[owner] == "corridor"]
    return _iou(unary_union(drawn), corridors) if drawn else 0.0


def _false_rooms(kinds: dict[str, str], rooms: list[dict[str, Any]], owners: list[str | None]) -> int:
    count, taken = 0, set()
    for room, owner in zip(rooms, owners, strict=True):
        if room["partial"]:
            continue
        if owner is None or (owner in taken and kinds[owner] == "room"):
            count += 1
        taken.add(owner)
    return count


def door_scores(case: Case) -> dict[str, Any]:
    """Doors walked through: found, width error; false: drawn ones where the truth has no door or glass wall."""
    true = [opening for opening in case.truth["openings"] if opening["kind"] in ("door", "glass-wall")]
    drawn = [opening for opening in case.plan["openings"] if opening["kind"] in ("door", "passage")]
    walked = [door for door in true if door["walked_through"]]
    widths, found = [], 0
    for door in walked:
        matches = [opening for opening in drawn if _same_place(case, opening, door)]
        found += bool(matches)
        if matches:
            widths.append(min(abs(match["width_m"] - door["width_m"]) for match in matches))
    false = sum(not any(_same_place(case, opening, door) for door in true) for opening in drawn)
    return {
        "walked": len(walked),
        "found": found / len(walked) if walked else None,
        "drawn": len(drawn),
        "false": false / len(drawn) if drawn else 0.0,
        "width_error_m": float(np.mean(widths)) if widths else None,
    }


def width_scores(case: Case) -> dict[str, Any]:
    """Widths of all drawn openings that are true doors or windows, walked through and glimpsed: errors, share within the 95 % interval."""
    true = [opening for opening in case.truth["openings"] if opening["kind"] in ("door", "window")]
    pairs = [(opening, door) for door in true for opening in case.plan["openings"] if _same_place(case, opening, door)]
    error = np.array([opening["width_m"] - door["width_m"] for opening, door in pairs])
    sigma = np.array([opening["width_sigma_m"] for opening, _ in pairs])
    if not len(error):
        return {"count": 0, "mean_m": None, "rms_m": None, "within_95": None}
    within = float((np.abs(error) <= Z95 * sigma).mean())
    return {"count": len(error), "mean_m": float(error.mean()), "rms_m": float(np.sqrt((error**2).mean())), "within_95": within}


def _same_place(case: Case, opening: dict[str, Any], door: dict[str, Any]) -> bool:
    along = door["along_axis"]
    off = np.abs(case.placement.xy(opening["centre"]) - np.array(door["centre"]))
    reach = max(DOOR_ALONG_M, door["width_m"] / 2)
    return bool(case.placement.axis(opening["along_axis"]) == along and off[along] < reach and off[1 - along] < DOOR_ACROSS_M)
