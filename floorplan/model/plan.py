"""The floor plan as a value: what `6-plan` makes, `plan.json` holds and every writer draws.

Everything is in the plan frame: right-handed, z up, x and y along the walls, metres, floor at z = 0 when seen,
the longest wall along x. Ids are short words: planes P1.., walls W1.., free lines L1..,
openings O1.., rooms R1.., columns C1.., dimensions D1...
"""

from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from floorplan.model.checks import Array, freeze
from floorplan.model.error_parts import SigmaParts
from floorplan.model.scan import Trajectory
from floorplan.model.site import Site

Point = tuple[float, float]  # x, y in the plan frame, metres


class Certainty(StrEnum):
    """Seen by the sensor, or concluded from what was seen."""

    SEEN = "seen"
    INFERRED = "inferred"


class OpeningKind(StrEnum):
    DOOR = "door"
    PASSAGE = "passage"
    WINDOW = "window"


class RoomKind(StrEnum):
    ROOM = "room"
    CORRIDOR = "corridor"


@dataclass(frozen=True)
class PlanPlane:
    """One layout plane in the plan frame: `axis` 0, 1, 2; `facing` +1 or -1; `extent_m` ((x0, x1), (y0, y1), (z0, z1))."""

    id: str
    axis: int
    facing: int
    offset_m: float
    sigma_m: float
    extent_m: tuple[Point, Point, Point]
    tracks: tuple[int, ...] = ()
    frames: int = 0  # how many frames saw it


@dataclass(frozen=True)
class Face:
    """A straight piece of one plane that was judged to be wall surface, from `start` to `end`, room side on `facing`."""

    id: str
    plane: str
    start: Point
    end: Point
    certainty: Certainty
    low_m: float | None = None  # lowest and highest height seen above the floor, None for level sweeps
    high_m: float | None = None


@dataclass(frozen=True)
class Wall:
    """One wall: its outline in lines as they are drawn, and what is known of its thickness.

    `seen` polylines go on the wall layer, `inferred` ones (bridged gaps, unseen ends) on the inferred layer;
    `fill` is the closed outline to hatch, empty for a face without a partner. A polyline that ends where it began is closed.
    """

    id: str
    faces: tuple[str, ...]
    seen: tuple[tuple[Point, ...], ...]
    inferred: tuple[tuple[Point, ...], ...] = ()
    fill: tuple[Point, ...] = ()
    thickness_m: float | None = None
    thickness_sigma_m: float | None = None
    height_m: float | None = None


@dataclass(frozen=True)
class FreeLine:
    """A wall off the axes, outside the Manhattan model: a straight line with the angle it makes with the nearest axis."""

    id: str
    start: Point
    end: Point
    sigma_m: float
    off_axis_deg: float
    low_m: float | None = None
    high_m: float | None = None


@dataclass(frozen=True)
class Glazing:
    """A stretch where a see-through surface stands: rays went through between mullions or hits."""

    id: str
    start: Point
    end: Point


@dataclass(frozen=True)
class Opening:
    """A door, passage or window: `centre` on the wall's mid line, `along_axis` 0 or 1 the direction its width runs in."""

    id: str
    kind: OpeningKind
    centre: Point
    along_axis: int
    width_m: float
    width_sigma_m: float
    walls: tuple[str, ...] = ()
    depth_m: float = 0.0  # thickness of the wall it goes through, 0 where unknown
    head_height_m: float | None = None
    sill_height_m: float | None = None
    walked_through: bool = False


@dataclass(frozen=True)
class Room:
    """A room or corridor on its inner faces: `outline` counter-clockwise, first point not repeated; `holes` clockwise; net area."""

    id: str
    kind: RoomKind
    name: str
    outline: tuple[Point, ...]
    area_m2: float
    area_sigma_m2: float
    holes: tuple[tuple[Point, ...], ...] = ()
    label: Point = (0.0, 0.0)  # a point inside, where the stamp goes
    ceiling_height_m: float | None = None
    ceiling_sigma_m: float | None = None
    visited: bool = True
    partial: bool = False  # glimpsed through an opening, or not closed by seen walls


@dataclass(frozen=True)
class Column:
    """A free-standing column: closed outline without repetition of the first point."""

    id: str
    outline: tuple[Point, ...]


class DimensionRole(StrEnum):
    """Where a dimension belongs in the drawing."""

    ROOM = "room"  # inside a room, between two facing walls
    CHAIN = "chain"  # outside, along the building
    OVERALL = "overall"
    HEIGHT = "height"  # floor to ceiling: listed, not drawn


@dataclass(frozen=True)
class Dimension:
    """Distance between two planes along an axis, face to face, with its standard deviation from the joint covariance.

    `start` and `end` are points on the two faces; `line` is a point the dimension line passes through. `sigma_parts`: what `sigma_m` is
    made of; None where a plane is none of the solution's, or the solution came without.
    """

    id: str
    role: DimensionRole
    from_plane: str
    to_plane: str
    axis: int
    distance_m: float
    sigma_m: float
    start: Point
    end: Point
    line: Point
    room: str = ""
    sigma_parts: SigmaParts | None = None


@dataclass(frozen=True)
class Rejection:
    """How many candidates were kept off the plan for one reason, with the wall length they would have had."""

    reason: str
    count: int
    length_m: float


@dataclass(frozen=True)
class Plan:
    """One storey, and those above it where there are any.

    `elevation_m`: its floor above that of the lowest storey; heights are from its own floor. Storeys share x and y and the planes'
    ids. `plane_covariance_m2` follows the order of `planes`; `rotation_quarters` and `shift_m` take the axis-aligned world of the
    solution to the plan frame: quarter turns counter-clockwise, then the shift (3,).
    """

    planes: tuple[PlanPlane, ...]
    faces: tuple[Face, ...]
    walls: tuple[Wall, ...]
    trajectory: Trajectory
    rotation_quarters: int
    shift_m: Array
    free_lines: tuple[FreeLine, ...] = ()
    glazing: tuple[Glazing, ...] = ()
    openings: tuple[Opening, ...] = ()
    rooms: tuple[Room, ...] = ()
    columns: tuple[Column, ...] = ()
    dimensions: tuple[Dimension, ...] = ()
    gross_outline: tuple[tuple[Point, ...], ...] = ()
    plane_covariance_m2: Array | None = None
    evidence_xy_m: Array = field(default_factory=lambda: np.zeros((0, 2)))  # thinned points at wall height, for the V-PNTS layer
    rejections: tuple[Rejection, ...] = ()
    notes: tuple[str, ...] = ()
    floor_seen: bool = False
    level: str = ""
    site: Site | None = None  # where the plan's frame lies on the site grid, where that is known
    elevation_m: float = 0.0
    upper_storeys: tuple["Plan", ...] = ()

    @property
    def storeys(self) -> tuple["Plan", ...]:
        """Every storey by itself, from below upwards."""
        return (replace(self, upper_storeys=()), *self.upper_storeys) if self.upper_storeys else (self,)

    def __post_init__(self) -> None:
        freeze(
            self,
            {
                "shift_m": (np.float64, (3,)),
                "plane_covariance_m2": (np.float64, ("L", "L")),
                "evidence_xy_m": (np.float64, ("V", 2)),
            },
        )
