"""A part of a walk, recorded as a scan of its own: two parts of one walk are two scans of one building."""

from dataclasses import dataclass

from floorplan.errors import UsageError
from floorplan.simulate.walk import Walk

PER_MILLE = 1000  # grain in which the ends of a part choose its random numbers


@dataclass(frozen=True)
class WalkPart:
    """From which share of the walk to which, 0 to 1; a part that ends before it begins is walked backwards in place and time."""

    begin: float = 0.0
    end: float = 1.0

    def of(self, walk: Walk) -> Walk:
        """The frames of the part; the stamps are those of the whole walk."""
        low, high = sorted((round(self.begin * len(walk)), round(self.end * len(walk))))
        kept = slice(low, high)
        if self.end > self.begin:
            return Walk(walk.stamp_ns[kept], walk.position_m[kept], walk.world_from_camera[kept], walk.yaw_rad[kept])
        stamps = walk.stamp_ns[low] + walk.stamp_ns[high - 1] - walk.stamp_ns[kept][::-1]
        return Walk(stamps, walk.position_m[kept][::-1], walk.world_from_camera[kept][::-1], walk.yaw_rad[kept][::-1])

    def seeds(self, *seeds: int) -> list[int]:
        """Seeds of random numbers that belong to this part; for the whole walk just the given ones."""
        own = [] if self == WHOLE_WALK else [round(PER_MILLE * self.begin), round(PER_MILLE * self.end)]
        return [*seeds, *own]


WHOLE_WALK = WalkPart()


def walk_part(text: str) -> WalkPart:
    """The part that `0:0.6` names. Raises `UsageError` for anything but two different shares."""
    try:
        begin, end = (float(share) for share in text.split(":"))
    except ValueError:
        raise UsageError(f"--walk-part {text}: write two shares of the walk, such as 0:0.6") from None
    if not (0 <= min(begin, end) < max(begin, end) <= 1):
        raise UsageError(f"--walk-part {text}: the shares are two different numbers from 0 to 1")
    return WalkPart(begin, end)
