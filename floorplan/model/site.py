"""Where a plan lies on the site grid: east and north, metres."""

import math
from dataclasses import dataclass

Point = tuple[float, float]


@dataclass(frozen=True)
class ControlPoint:
    """A point known in both systems: `plan` (after snapping to a corner, `snapped`), its `site` (east, north), and by how much
    the placed plan misses it, `residual_m` (east, north; placed minus given)."""

    name: str
    plan: Point
    site: Point
    snapped: bool
    residual_m: Point

    @property
    def miss_m(self) -> float:
        return math.hypot(*self.residual_m)


@dataclass(frozen=True)
class Site:
    """Plan to site: turned by `rotation_deg` counter-clockwise about the plan's origin, which then lies at `east_m`, `north_m`.

    Lengths stay those of the plan. `scale` is what the control points would ask for (site length / plan length), with its
    standard deviation; None where they cannot say. `warnings` are sentences.
    """

    rotation_deg: float
    east_m: float
    north_m: float
    points: tuple[ControlPoint, ...] = ()
    scale: float | None = None
    scale_sigma: float | None = None
    warnings: tuple[str, ...] = ()

    @property
    def north_deg(self) -> float:
        """Where the grid's north lies on the plan, degrees counter-clockwise from +y."""
        return -self.rotation_deg

    def to_site(self, point: Point) -> Point:
        """East and north of a point of the plan."""
        cos, sin = math.cos(math.radians(self.rotation_deg)), math.sin(math.radians(self.rotation_deg))
        return self.east_m + cos * point[0] - sin * point[1], self.north_m + sin * point[0] + cos * point[1]
