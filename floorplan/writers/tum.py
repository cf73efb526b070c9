"""Trajectories as text: `stamp tx ty tz qx qy qz qw` a line, metres, sensor to plan frame."""

from pathlib import Path

from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.scan import NANOSECONDS_PER_SECOND, Trajectory

ROW = "%s" + " %.6f" * 3 + " %.9f" * 4 + "\n"


def write_tum(trajectory: Trajectory, path: Path) -> None:
    """Write `trajectory` to `path`; the stamps are the source's own, exact to the nanosecond."""
    quats = quat_xyzw_from_rotation(trajectory.world_from_sensor)
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("# stamp tx ty tz qx qy qz qw\n")
        for stamp, position, quat in zip(trajectory.stamp_ns.tolist(), trajectory.position_m.tolist(), quats.tolist(), strict=True):
            file.write(ROW % (_seconds(stamp), *position, *quat))


def _seconds(stamp_ns: int) -> str:
    """Seconds with nine decimals, without the rounding of a float."""
    sign, size = ("-", -stamp_ns) if stamp_ns < 0 else ("", stamp_ns)
    return f"{sign}{size // NANOSECONDS_PER_SECOND}.{size % NANOSECONDS_PER_SECOND:09d}"
