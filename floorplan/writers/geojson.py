"""The plan as a GeoJSON FeatureCollection in metres: of the plan frame, x and y along the walls, or of the site grid where it is placed."""

import json
from typing import Any

from floorplan.model.plan import Certainty, Plan, Point
from floorplan.model.site import Site

MILLIMETRE_DIGITS = 4  # decimals of a metre kept: a tenth of a millimetre

Feature = dict[str, Any]


def geojson_bytes(plan: Plan) -> bytes:
    """One feature per line: rooms and columns as polygons, walls and glazing as lines, openings as points with their width."""
    features = [feature for storey in plan.storeys for feature in _storey(storey)]
    if plan.site is not None:
        for feature in features:
            feature["geometry"]["coordinates"] = _placed(feature["geometry"]["coordinates"], plan.site)
    frame = "plan: x and y along the walls" if plan.site is None else "site grid: east and north"
    lines = ",\n".join(json.dumps(feature, ensure_ascii=False) for feature in features)
    head = f'{{"type": "FeatureCollection", "units": "m", "frame": "{frame}", "features": ['
    return f"{head}\n{lines}\n]}}\n".encode()


def _placed(coordinates: Any, site: Site) -> Any:
    """Every position of a geometry on the site grid."""
    if isinstance(coordinates[0], list):
        return [_placed(part, site) for part in coordinates]
    return _position(site.to_site((coordinates[0], coordinates[1])))


def _storey(plan: Plan) -> list[Feature]:
    """Features of one storey; they say which one where it has a name."""
    features = [*_rooms(plan), *_gross(plan), *_walls(plan), *_lines(plan), *_openings(plan), *_columns(plan)]
    if plan.level:
        for feature in features:
            feature["properties"] |= {"storey": plan.level, "elevation_m": plan.elevation_m}
    return features


def _feature(kind: str, identity: str, geometry: str, coordinates: Any, **properties: Any) -> Feature:
    return {
        "type": "Feature",
        "id": identity,
        "properties": {"kind": kind, **properties},
        "geometry": {"type": geometry, "coordinates": coordinates},
    }


def _position(point: Point) -> list[float]:
    return [round(float(point[0]), MILLIMETRE_DIGITS), round(float(point[1]), MILLIMETRE_DIGITS)]


def _line(points: tuple[Point, ...]) -> list[list[float]]:
    return [_position(point) for point in points]


def _ring(points: tuple[Point, ...]) -> list[list[float]]:
    """A linear ring repeats its first point (RFC 7946)."""
    ring = points if points[0] != points[-1] else points[:-1]
    return _line((*ring, ring[0]))


def _rooms(plan: Plan) -> list[Feature]:
    return [
        _feature(
            "room",
            room.id,
            "Polygon",
            [_ring(room.outline), *(_ring(hole) for hole in room.holes)],
            room_kind=room.kind.value,
            name=room.name,
            area_m2=room.area_m2,
            area_sigma_m2=None if room.partial else room.area_sigma_m2,
            ceiling_height_m=room.ceiling_height_m,
            visited=room.visited,
            partial=room.partial,
        )
        for room in plan.rooms
    ]


def _gross(plan: Plan) -> list[Feature]:
    return [_feature("gross outline", f"gross-{number}", "Polygon", [_ring(ring)]) for number, ring in enumerate(plan.gross_outline, 1)]


def _walls(plan: Plan) -> list[Feature]:
    features = []
    for wall in plan.walls:
        about = {"thickness_m": wall.thickness_m, "thickness_sigma_m": wall.thickness_sigma_m, "height_m": wall.height_m}
        for certainty, lines in ((Certainty.SEEN, wall.seen), (Certainty.INFERRED, wall.inferred)):
            if lines:
                coordinates = [_line(line) for line in lines]
                features.append(
                    _feature("wall", f"{wall.id}-{certainty.value}", "MultiLineString", coordinates, certainty=certainty.value, **about)
                )
    return features


def _lines(plan: Plan) -> list[Feature]:
    free = [
        _feature("free line", line.id, "LineString", _line((line.start, line.end)), sigma_m=line.sigma_m, off_axis_deg=line.off_axis_deg)
        for line in plan.free_lines
    ]
    return free + [_feature("glazing", pane.id, "LineString", _line((pane.start, pane.end))) for pane in plan.glazing]


def _openings(plan: Plan) -> list[Feature]:
    return [
        _feature(
            opening.kind.value,
            opening.id,
            "Point",
            _position(opening.centre),
            along_axis="xy"[opening.along_axis],
            width_m=opening.width_m,
            width_sigma_m=opening.width_sigma_m,
            head_height_m=opening.head_height_m,
            walked_through=opening.walked_through,
        )
        for opening in plan.openings
    ]


def _columns(plan: Plan) -> list[Feature]:
    return [_feature("column", column.id, "Polygon", [_ring(column.outline)]) for column in plan.columns]
