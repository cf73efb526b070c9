"""Trajectories as text: `stamp tx ty tz qx qy qz qw` a line, metres, sensor to plan frame."""

from pathlib import Path

from floorplan.geometry import quat_xyzw_from_rotation
from floorplan.model.scan import NANOSECONDS_PER_SECOND, Trajectory


def write_tum(trajectory: Trajectory, path: Path) -> None:
    """Write `trajectory` to `path`; the stamps are the source's own, exact to the nanosecond."""
    quats = quat_xyzw_from_rotation(trajectory.world_from_sensor)
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write("# stamp tx ty tz qx qy qz qw\n")
        for stamp, position, quat in zip(trajectory.stamp_ns.tolist(), trajectory.position_m, quats, strict=True):
            numbers = " ".join(f"{number:.6f}" for number in position) + " " + " ".join(f"{number:.9f}" for number in quat)
            file.write(f"{_seconds(stamp)} {numbers}\n")


def _seconds(stamp_ns: int) -> str:
    """Seconds with nine decimals, without the rounding of a float."""
    sign, size = ("-", -stamp_ns) if stamp_ns < 0 else ("", stamp_ns)
    return f"{sign}{size // NANOSECONDS_PER_SECOND}.{size % NANOSECONDS_PER_SECOND:09d}"
