"""Tables to carry to site: dimensions with an empty column for the measured value, and the room schedule; metres, UTF-8."""

import csv
import io
from collections.abc import Iterable

from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Plan, Point

DIMENSION_COLUMNS = ("id", "plan_m", "plus_minus_95_m", "from", "to", "direction", "kind", "room", "x1", "y1", "x2", "y2", "measured_m")
ROOM_COLUMNS = (
    "number",
    "name",
    "kind",
    "area_m2",
    "plus_minus_95_m2",
    "ceiling_height_m",
    "ceiling_plus_minus_95_m",
    "visited",
    "partial",
)
AXES = ("x", "y", "height")


def dimensions_csv(plan: Plan) -> bytes:
    """One row per dimension, heights too; with `measured_m` filled in, `check` and `--laser` read the same file by `id`."""
    rows = (
        (
            *_storey(plan, storey),
            dimension.id,
            f"{dimension.distance_m:.4f}",
            f"{NORMAL_95 * dimension.sigma_m:.4f}",
            dimension.from_plane,
            dimension.to_plane,
            AXES[dimension.axis],
            dimension.role.value,
            dimension.room,
            *(f"{value:.3f}" for value in (*dimension.start, *dimension.end)),
            "",
            *_on_site(plan, dimension.start),
            *_on_site(plan, dimension.end),
        )
        for storey in plan.storeys
        for dimension in storey.dimensions
    )
    return _table((*_storey_column(plan), *DIMENSION_COLUMNS, *_site_columns(plan, "east1", "north1", "east2", "north2")), rows)


def rooms_csv(plan: Plan) -> bytes:
    """One row per room; an unknown height is an empty cell, and so is the interval of an area that was seen in part."""
    rows = (
        (
            *_storey(plan, storey),
            room.id,
            room.name,
            room.kind.value,
            f"{room.area_m2:.3f}",
            "" if room.partial else f"{NORMAL_95 * room.area_sigma_m2:.3f}",
            _metres(room.ceiling_height_m),
            _metres(None if room.ceiling_sigma_m is None else NORMAL_95 * room.ceiling_sigma_m),
            "yes" if room.visited else "no",
            "yes" if room.partial else "no",
            *_on_site(plan, room.label),
        )
        for storey in plan.storeys
        for room in storey.rooms
    )
    return _table((*_storey_column(plan), *ROOM_COLUMNS, *_site_columns(plan, "east", "north")), rows)


def _storey_column(plan: Plan) -> tuple[str, ...]:
    """The column that says which storey; plans of one storey need none."""
    return ("storey",) if plan.upper_storeys else ()


def _storey(plan: Plan, storey: Plan) -> tuple[str, ...]:
    return (storey.level,) if plan.upper_storeys else ()


def _site_columns(plan: Plan, *names: str) -> tuple[str, ...]:
    """Columns that only a plan on a site grid has."""
    return names if plan.site is not None else ()


def _on_site(plan: Plan, point: Point) -> tuple[str, ...]:
    return () if plan.site is None else tuple(f"{value:.3f}" for value in plan.site.to_site(point))


def _metres(value_m: float | None) -> str:
    return "" if value_m is None else f"{value_m:.3f}"


def _table(columns: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> bytes:
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(rows)
    return stream.getvalue().encode("utf-8")
