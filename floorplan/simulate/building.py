"""The words of a simulated building: spaces, openings, boxes, and the surfaces that follow from them.

Everything is exact and axis-aligned (but for open door leaves), in the building's own frame: metres, z up, floor at z = 0.
"""

from dataclasses import dataclass, field
from enum import StrEnum

from shapely.geometry import Polygon


class SpaceKind(StrEnum):
    ROOM = "room"
    CORRIDOR = "corridor"


class OpeningKind(StrEnum):
    DOOR = "door"
    WINDOW = "window"
    GLASS_WALL = "glass-wall"


class BoxKind(StrEnum):
    FURNITURE = "furniture"
    CABINET = "cabinet"  # tall: 1.6 to 2.0 m
    BEAM = "beam"
    MULLION = "mullion"
    LEAF = "door-leaf"


class SurfaceKind(StrEnum):
    WALL = "wall"
    COLUMN = "column"
    LINTEL = "lintel"  # wall above a door or a window
    SILL = "sill"  # wall below a window
    JAMB = "jamb"
    FLOOR = "floor"
    CEILING = "ceiling"
    BOX = "box"
    GLASS = "glass"


@dataclass(frozen=True)
class Rect:
    """A rectangle in plan: x0 < x1, y0 < y1, metres."""

    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def polygon(self) -> Polygon:
        """The rectangle as a shapely polygon."""
        return Polygon([(self.x0, self.y0), (self.x1, self.y0), (self.x1, self.y1), (self.x0, self.y1)])

    @property
    def centre(self) -> tuple[float, float]:
        """The middle (x, y)."""
        return (self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2

    def interval(self, axis: int) -> tuple[float, float]:
        """The range along `axis` (0 = x, 1 = y)."""
        return (self.x0, self.x1) if axis == 0 else (self.y0, self.y1)

    def size(self, axis: int) -> float:
        """The length along `axis`."""
        low, high = self.interval(axis)
        return high - low


def rect_along(axis: int, along: tuple[float, float], across: tuple[float, float]) -> Rect:
    """The rectangle that covers `along` on `axis` and `across` on the other axis."""
    if axis == 0:
        return Rect(along[0], across[0], along[1], across[1])
    return Rect(across[0], along[0], across[1], along[1])


@dataclass(frozen=True)
class Space:
    """A room or corridor: its free outline on the inner faces and its clear height."""

    id: str
    kind: SpaceKind
    outline: Polygon
    ceiling_m: float


@dataclass(frozen=True)
class Opening:
    """A hole of the whole wall's depth: `rect` in plan, `along` the axis its width runs in, from `sill_m` to `head_m`.

    `spaces` are the two sides; an empty word means outdoors.
    """

    id: str
    kind: OpeningKind
    rect: Rect
    along: int
    sill_m: float
    head_m: float
    spaces: tuple[str, str]


@dataclass(frozen=True)
class Box:
    """A solid of height `z0_m` to `z1_m` over a convex `outline` in plan; `dark` ones return few echoes."""

    kind: BoxKind
    outline: Polygon
    z0_m: float
    z1_m: float
    dark: bool = False


@dataclass(frozen=True)
class Building:
    """An exact building: `outline` is the gross outline, solid wherever there is neither space nor opening."""

    spaces: tuple[Space, ...]
    openings: tuple[Opening, ...]
    outline: Polygon
    boxes: tuple[Box, ...] = field(default_factory=tuple)

    def space(self, space_id: str) -> Space:
        """The space with that id."""
        return next(space for space in self.spaces if space.id == space_id)

    @property
    def doors(self) -> tuple[Opening, ...]:
        """The openings one can walk through."""
        return tuple(opening for opening in self.openings if opening.kind is OpeningKind.DOOR)
