"""The formats a simulated scan can be written in, each with the instrument that makes such recordings."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Protocol

from floorplan.errors import UsageError
from floorplan.model.checks import Array
from floorplan.simulate.laser import LaserScanner, rolled
from floorplan.simulate.lidar import SpinningLidar, carried
from floorplan.simulate.odometry import Odometry
from floorplan.simulate.presets import PHONE
from floorplan.simulate.raycast import RayCaster
from floorplan.simulate.scene import Scene
from floorplan.simulate.sensor import DepthCamera, Shot, pinhole_of
from floorplan.simulate.walk import Walk
from floorplan.simulate.write_carmen import CarmenWriter
from floorplan.simulate.write_clouds import KINDS as CLOUD_KINDS
from floorplan.simulate.write_clouds import CloudsWriter
from floorplan.simulate.write_posed import LAYOUTS, PosedWriter
from floorplan.simulate.write_record3d import Record3dWriter
from floorplan.simulate.write_ros import RosWriter
from floorplan.simulate.write_stray import StrayWriter
from floorplan.simulate.write_tum import TumWriter


class Instrument(Protocol):
    """Takes one shot per pose; `rays (H * W, 3)` in its own axes, in the units its depths count."""

    rays: Array

    def shots(self, walk: Walk) -> Iterator[Shot]:
        """One shot per pose of the walk."""
        ...


class Writer(Protocol):
    """Writes a scan frame by frame."""

    def frame(self, index: int, shot: Shot) -> None:
        """One frame's depth."""
        ...

    def finish(self, walk: Walk, odometry: Odometry) -> None:
        """What belongs to the whole scan."""
        ...


@dataclass(frozen=True)
class Format:
    """How a scan of one format is made: the scene as its instrument is moved in it, the instrument, the writer."""

    scene: Callable[[Scene], Scene]
    instrument: Callable[[Scene, RayCaster, bool, float], Instrument]
    writer: Callable[[Path, Any, int], Writer]
    coverage_stride: int


def _camera(scene: Scene, caster: RayCaster, hard: bool, image_scale: float) -> DepthCamera:
    sensor = scene.preset.sensor
    return DepthCamera(sensor, pinhole_of(sensor, image_scale), caster, scene.seed, biased=hard)


def _laser(scene: Scene, caster: RayCaster, hard: bool, _image_scale: float) -> LaserScanner:
    return LaserScanner(caster, scene.seed, slips=hard)


def _lidar(scene: Scene, caster: RayCaster, _hard: bool, image_scale: float) -> SpinningLidar:
    return SpinningLidar(caster, scene.seed, image_scale)


def _ros_writer(kind: str, folder: Path, instrument: Any, seed: int) -> RosWriter:
    del seed  # nothing random in this format
    return RosWriter(folder, instrument, kind)


def _posed_writer(name: str, folder: Path, instrument: Any, seed: int) -> PosedWriter:
    del seed  # nothing random in these formats
    return PosedWriter(folder, instrument, LAYOUTS[name])


def _clouds_writer(kind: str, folder: Path, instrument: Any, seed: int) -> CloudsWriter:
    del seed  # nothing random in these formats
    return CloudsWriter(folder, instrument, kind)


def _record3d_writer(folder: Path, instrument: Any, seed: int) -> Record3dWriter:
    del seed  # nothing random in this format
    return Record3dWriter(folder, instrument)


def _as_drawn(scene: Scene) -> Scene:
    return scene


def _with_phone(scene: Scene) -> Scene:
    return replace(scene, preset=replace(scene.preset, sensor=PHONE))


def _on_wheels(scene: Scene) -> Scene:
    return replace(scene, walk=rolled(scene.walk))


def _with_lidar(scene: Scene) -> Scene:
    return replace(scene, walk=carried(scene.walk))


BAG_KINDS = ("ros1", "db3", "mcap")
FORMATS = {
    "tum": Format(_as_drawn, _camera, TumWriter, 2),
    "stray": Format(_with_phone, _camera, StrayWriter, 2),
    **{name: Format(_with_phone, _camera, partial(_posed_writer, name), 2) for name in LAYOUTS},
    "record3d": Format(_with_phone, _camera, _record3d_writer, 2),
    "carmen": Format(_on_wheels, _laser, CarmenWriter, 1),
    **{kind: Format(_as_drawn, _camera, partial(_ros_writer, kind), 2) for kind in BAG_KINDS},
}
LIDAR_FORMATS = {
    **{kind: Format(_with_lidar, _lidar, partial(_ros_writer, kind), 1) for kind in BAG_KINDS},
    **{kind: Format(_with_lidar, _lidar, partial(_clouds_writer, kind), 1) for kind in CLOUD_KINDS},
}
SENSORS = {"": FORMATS, "lidar16": LIDAR_FORMATS}  # the format's own instrument, or another one


def format_named(name: str, sensor: str = "") -> Format:
    """The format of that name, for the format's own or another sensor; raises `UsageError` naming the choices."""
    if sensor not in SENSORS:
        raise UsageError(f"no sensor '{sensor}' to simulate; choose one of {', '.join(filter(None, SENSORS))}, or none")
    formats = SENSORS[sensor]
    if name not in formats:
        kind = f" with {sensor}" if sensor else ""
        raise UsageError(f"no format '{name}' to simulate in{kind}; choose one of {', '.join(formats)}")
    return formats[name]
