"""The transform tree of a bag: static edges, moving edges, and the way from one frame to another."""

from dataclasses import dataclass, field

import numpy as np

from floorplan.geometry import rotation_from_quat_xyzw
from floorplan.model.checks import Array
from floorplan.readers.pose_table import PoseTable, interpolate
from floorplan.readers.row_checks import usable_rows

MAX_POSE_GAP_S = 0.5  # nothing to interpolate over a longer silence
FIXED_FRAMES = ("odom", "odometry")  # where the odometry is smooth; a map frame above it jumps when a loop is closed


@dataclass(frozen=True)
class TimedPose:
    """One transform or pose: `position_m (3,)`, `quat_xyzw (4,)`."""

    stamp_ns: int
    position_m: tuple[float, float, float]
    quat_xyzw: tuple[float, float, float, float]


def table_of(poses: list[TimedPose]) -> PoseTable:
    """All poses as a table."""
    return PoseTable(
        np.array([p.stamp_ns for p in poses], dtype=np.int64),
        np.array([p.position_m for p in poses]).reshape(-1, 3),
        np.array([p.quat_xyzw for p in poses]).reshape(-1, 4),
    )


@dataclass(frozen=True)
class Poses:
    """Poses at N times: `position_m (N, 3)`, `rotation (N, 3, 3)`, `known (N,)`."""

    position_m: Array
    rotation: Array
    known: Array

    def times(self, other: "Poses") -> "Poses":
        """`self` after `other`: parent_from_child times child_from_grandchild."""
        position = self.position_m + np.einsum("nij,nj->ni", self.rotation, other.position_m)
        return Poses(position, self.rotation @ other.rotation, self.known & other.known)


def identity_poses(count: int) -> Poses:
    """No motion, `count` times."""
    return Poses(np.zeros((count, 3)), np.tile(np.eye(3), (count, 1, 1)), np.ones(count, dtype=bool))


@dataclass
class TransformTree:
    """Edges by child frame: the child's parent and the poses of the child in it. Filled while the bag is read."""

    parent: dict[str, str] = field(default_factory=dict)
    poses: dict[str, list[TimedPose]] = field(default_factory=dict)
    static: set[str] = field(default_factory=set)

    def add(self, parent: str, child: str, pose: TimedPose, static: bool) -> None:
        """One message's transform; names without a leading slash."""
        parent, child = parent.lstrip("/"), child.lstrip("/")
        self.parent[child] = parent
        self.poses.setdefault(child, []).append(pose)
        if static:
            self.static.add(child)

    def ancestors(self, frame: str) -> list[str]:
        """`frame`, its parent, and so on."""
        chain = [frame]
        while chain[-1] in self.parent and self.parent[chain[-1]] not in chain:
            chain.append(self.parent[chain[-1]])
        return chain

    def fixed_frame(self, frame: str) -> str:
        """The frame that poses of `frame` are best told in: odometry's where there is one, else the root."""
        chain = self.ancestors(frame)
        return next((name for name in chain[1:] if name in FIXED_FRAMES), chain[-1])

    def lookup(self, ancestor: str, frame: str, stamp_ns: Array) -> Poses:
        """`ancestor_from_frame` at each stamp (N,); `ancestor` must be among the ancestors of `frame`."""
        result = identity_poses(len(stamp_ns))
        for child in self.ancestors(frame):
            if child == ancestor:
                break
            result = self._edge(child, stamp_ns).times(result)
        return result

    def _edge(self, child: str, stamp_ns: Array) -> Poses:
        table = table_of(self.poses[child])
        if child in self.static or len(table) == 1:
            count = len(stamp_ns)
            rotation = rotation_from_quat_xyzw(table.quat_xyzw[-1])
            return Poses(np.tile(table.position_m[-1], (count, 1)), np.tile(rotation, (count, 1, 1)), np.ones(count, dtype=bool))
        return poses_at(table, stamp_ns)


def poses_at(table: PoseTable, stamp_ns: Array) -> Poses:
    """Interpolated poses at the stamps (N,); unknown in gaps and outside."""
    usable = usable_rows(table, "poses")
    if not len(usable.index):
        unknown = identity_poses(len(stamp_ns))
        return Poses(unknown.position_m, unknown.rotation, ~unknown.known)
    found = interpolate(table.rows(usable.index), stamp_ns, MAX_POSE_GAP_S)
    return Poses(found.position_m, found.rotation, found.known)
