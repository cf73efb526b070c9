"""A simulated scan as phone apps and ScanNet write theirs: a depth image, a pose and intrinsics per frame."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.geometry import vector_from_rotation
from floorplan.model.checks import Array
from floorplan.model.scan import Intrinsics
from floorplan.simulate.odometry import Odometry
from floorplan.simulate.png import write_png8, write_png16
from floorplan.simulate.sensor import DepthCamera, Pinhole, Shot
from floorplan.simulate.stamps import seconds_text
from floorplan.simulate.walk import Walk
from floorplan.simulate.write_stray import ARKIT_FROM_LEVEL, COLOUR_WIDTH, confidence_of

UNITS_PER_METRE = 1000
ARKIT_FROM_OPENCV = np.diag([1.0, -1.0, -1.0])  # camera axes: y up, looking along -z
VIDEO = "41000001"  # what ARKitScenes calls a sequence
NANOSECONDS_PER_MICROSECOND = 1000
SCANNET_NS = 1_000_000_000 / 30


@dataclass(frozen=True)
class FrameFacts:
    """One frame to write: number, stamp, `pose (4, 4)` camera-to-world in OpenCV axes and a z-up world, the lenses of
    the colour and of the depth image."""

    number: int
    stamp_ns: int
    pose: Array
    colour: Intrinsics
    depth: Pinhole

    def in_arkit(self) -> Array:
        """The pose (4, 4) in ARKit's axes: world +y up, camera y up."""
        pose = np.eye(4)
        pose[:3, :3] = ARKIT_FROM_LEVEL @ self.pose[:3, :3] @ ARKIT_FROM_OPENCV
        pose[:3, 3] = ARKIT_FROM_LEVEL @ self.pose[:3, 3]
        return pose


@dataclass(frozen=True)
class Layout:
    """Where one format keeps its images (by number and stamp), and how it writes a frame's facts and the facts of the whole."""

    depth: Callable[[int, int], str]
    confidence: Callable[[int, int], str] | None
    confidence_step: int
    frame: Callable[[Path, FrameFacts], None]
    whole: Callable[[Path, list[FrameFacts]], None]


class PosedWriter:
    """Writes depth and confidence frame by frame under their numbers; names by stamp and poses at the end."""

    def __init__(self, folder: Path, instrument: DepthCamera, layout: Layout) -> None:
        self.folder, self.camera, self.layout = folder, instrument.pinhole, layout
        self._kept: list[tuple[Path, Path]] = []
        folder.mkdir(parents=True, exist_ok=True)

    def frame(self, index: int, shot: Shot) -> None:
        """One depth image and its confidence, under temporary names."""
        depth, confidence = self.folder / f"{index}.depth.png", self.folder / f"{index}.conf.png"
        write_png16(depth, shot.depth_m * UNITS_PER_METRE)
        if self.layout.confidence is not None:
            write_png8(confidence, np.minimum(confidence_of(shot) * self.layout.confidence_step, np.iinfo(np.uint8).max))
        self._kept.append((depth, confidence))

    def finish(self, walk: Walk, odometry: Odometry) -> None:
        """The images under their names, poses, intrinsics."""
        colour = colour_lens(self.camera)
        facts = []
        for index, stamp_ns in enumerate(walk.stamp_ns.tolist()):
            pose = np.eye(4)
            pose[:3, :3], pose[:3, 3] = odometry.odom_from_camera[index], odometry.position_m[index]
            facts.append(FrameFacts(index, stamp_ns, pose, colour, self.camera))
            self._named(index, stamp_ns)
            self.layout.frame(self.folder, facts[-1])
        self.layout.whole(self.folder, facts)

    def _named(self, index: int, stamp_ns: int) -> None:
        depth, confidence = self._kept[index]
        for old, name in ((depth, self.layout.depth), (confidence, self.layout.confidence)):
            if name is not None:
                new = self.folder / name(index, stamp_ns)
                new.parent.mkdir(parents=True, exist_ok=True)
                old.rename(new)


def colour_lens(camera: Pinhole) -> Intrinsics:
    """The lens of the colour image that is COLOUR_WIDTH wide. Whole numbers are pixel centres, so the middle moves by half a pixel."""
    scale = COLOUR_WIDTH / camera.width
    cx, cy = (camera.cx + 0.5) * scale - 0.5, (camera.cy + 0.5) * scale - 0.5
    return Intrinsics(COLOUR_WIDTH, round(camera.height * scale), camera.fx * scale, camera.fy * scale, cx, cy)


def _write_json(path: Path, tree: object) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(tree, indent=1) + "\n")


def _write_text(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text + "\n")


def _scanner3d_frame(folder: Path, facts: FrameFacts) -> None:
    lens = facts.colour
    projection = np.zeros((4, 4))
    projection[0, 0], projection[1, 1], projection[3, 2] = 2 * lens.fx / lens.width, 2 * lens.fy / lens.height, -1.0
    tree = {
        "cameraPoseARFrame": facts.in_arkit().ravel().tolist(),
        "intrinsics": [lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1],
        "projectionMatrix": projection.ravel().tolist(),
        "time": facts.stamp_ns / 1e9,
        "frame_index": facts.number,
    }
    _write_json(folder / f"frame_{facts.number:05d}.json", tree)


def _polycam_frame(folder: Path, facts: FrameFacts) -> None:
    pose, lens = facts.in_arkit(), facts.colour
    tree = {f"t_{row}{column}": pose[row, column] for row in range(3) for column in range(4)}
    size = {"width": lens.width, "height": lens.height, "fx": lens.fx, "fy": lens.fy, "cx": lens.cx, "cy": lens.cy}
    stamp = facts.stamp_ns // NANOSECONDS_PER_MICROSECOND
    _write_json(folder / "keyframes" / "cameras" / f"{stamp}.json", {**tree, **size, "timestamp": stamp, "blur_score": 100.0})


def _arkitscenes_frame(folder: Path, facts: FrameFacts) -> None:
    lens = facts.colour
    row = f"{lens.width} {lens.height} {lens.fx:.6f} {lens.fy:.6f} {lens.cx:.6f} {lens.cy:.6f}"
    _write_text(folder / "lowres_wide_intrinsics" / f"{VIDEO}_{seconds_text(facts.stamp_ns)}.pincam", row)


def _arkitscenes_trajectory(folder: Path, frames: list[FrameFacts]) -> None:
    inverse = np.linalg.inv(np.array([facts.pose for facts in frames]))
    rows = np.column_stack((vector_from_rotation(inverse[:, :3, :3]), inverse[:, :3, 3]))
    stamps = [seconds_text(facts.stamp_ns) for facts in frames]
    lines = [" ".join([stamp, *(f"{value:.9f}" for value in row)]) for stamp, row in zip(stamps, rows, strict=True)]
    _write_text(folder / "lowres_wide.traj", "\n".join(lines))


def _scannet_frame(folder: Path, facts: FrameFacts) -> None:
    text = "\n".join(" ".join(f"{value:.9f}" for value in row) for row in facts.pose)
    _write_text(folder / "pose" / f"{scannet_number(facts.stamp_ns)}.txt", text)


def _scannet_lens(folder: Path, frames: list[FrameFacts]) -> None:
    """Of the depth image."""
    lens, matrix = frames[0].depth, np.eye(4)
    matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2] = lens.fx, lens.fy, lens.cx, lens.cy
    _write_text(folder / "intrinsic" / "intrinsic_depth.txt", "\n".join(" ".join(f"{value:.9f}" for value in row) for row in matrix))


def scannet_number(stamp_ns: int) -> int:
    """The frame at 30 Hz that a stamp belongs to."""
    return round(stamp_ns / SCANNET_NS)


def _nothing(folder: Path, frames: list[FrameFacts]) -> None:
    """Formats whose frames say everything."""


def _micro(stamp_ns: int) -> str:
    return f"{stamp_ns // NANOSECONDS_PER_MICROSECOND}.png"


def _video(stamp_ns: int) -> str:
    return f"{VIDEO}_{seconds_text(stamp_ns)}.png"


LAYOUTS = {
    "scanner3d": Layout(lambda n, _: f"depth_{n:05d}.png", lambda n, _: f"conf_{n:05d}.png", 1, _scanner3d_frame, _nothing),
    "polycam": Layout(
        lambda _, ns: f"keyframes/depth/{_micro(ns)}", lambda _, ns: f"keyframes/confidence/{_micro(ns)}", 127, _polycam_frame, _nothing
    ),
    "arkitscenes": Layout(
        lambda _, ns: f"lowres_depth/{_video(ns)}", lambda _, ns: f"confidence/{_video(ns)}", 1, _arkitscenes_frame, _arkitscenes_trajectory
    ),
    "scannet": Layout(lambda _, ns: f"depth/{scannet_number(ns)}.png", None, 1, _scannet_frame, _scannet_lens),
}
