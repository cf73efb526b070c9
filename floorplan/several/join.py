"""Several solved scans as one: their recordings in one row, linked by the layings of their plans."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.plan import Plan
from floorplan.model.scan import GravitySource, IngestedScan, RangeAccuracy, Recording, ScanPart, Sensor, SensorKind, Trajectory
from floorplan.model.segment import SegmentedScan
from floorplan.several.lay import Laid
from floorplan.several.survey import quarter_turn
from floorplan.several.turned import turned

FLOOR_SIGMA_M = 0.03  # of one floor seen by two scans
HEIGHT_SIGMA_M = 0.5  # of the heights at which two people hold a sensor, where no floor was seen
UNKNOWN_ACCURACY = RangeAccuracy(0.0, 0.0)


@dataclass(frozen=True)
class SolvedScan:
    """One scan built on its own: what it is called and where it lies, its first stages, its plan."""

    name: str
    path: str
    scan: IngestedScan
    segmented: SegmentedScan
    plan: Plan


def joined_scan(scans: Sequence[SolvedScan], layings: Sequence[Laid]) -> IngestedScan:
    """One recording of all scans, each scan's odometry laid where its link says. Raises `InputError` for sensors that do not mix."""
    sensor = _common_sensor(scans)
    parts = _parts(scans, layings)
    moved = [_odometry(scans, parts, k) for k in range(len(scans))]
    sources = {scan.scan.recording.gravity_source for scan in scans}
    recordings = [scan.scan.recording for scan in scans]
    recording = Recording(
        format=" + ".join(dict.fromkeys(recording.format for recording in recordings)),
        sensor=sensor,
        stamp_ns=np.concatenate([recording.stamp_ns for recording in recordings]),
        position_m=np.concatenate([odometry.position_m for odometry in moved]),
        odom_from_sensor=np.concatenate([odometry.world_from_sensor for odometry in moved]),
        down_sensor=np.concatenate([recording.down_sensor for recording in recordings]),
        gravity_source=next(iter(sources)) if len(sources) == 1 else GravitySource.ESTIMATED,
        problems=tuple(replace(p, where=f"{scan.name}: {p.where}") for scan in scans for p in scan.scan.recording.problems),
    )
    keyframe = np.concatenate([scan.scan.keyframe + part.first_row for scan, part in zip(scans, parts, strict=True)])
    return IngestedScan(recording, keyframe, parts=parts)


def part_turned(segmented: SegmentedScan, part: ScanPart) -> SegmentedScan:
    """A scan's segments in the first scan's axis-aligned world."""
    return turned(segmented, part.quarters)


def _parts(scans: Sequence[SolvedScan], layings: Sequence[Laid]) -> tuple[ScanPart, ...]:
    base = scans[0].plan
    rows = np.cumsum([0, *(len(scan.scan.recording) for scan in scans)])
    keyframes = np.cumsum([0, *(len(scan.scan.keyframe) for scan in scans)])
    parts = []
    for k, (scan, laid) in enumerate(zip(scans, layings, strict=True)):
        link, sigma = np.zeros(3), np.zeros(3)
        if k:
            step = _placed(scan, laid)[0] - _placed(scans[k - 1], layings[k - 1])[-1]
            link = quarter_turn(-base.rotation_quarters) @ step
            level = float(np.hypot(laid.sigma_m, layings[k - 1].sigma_m))
            floors = scan.plan.floor_seen and scans[k - 1].plan.floor_seen
            sigma = np.array([level, level, FLOOR_SIGMA_M if floors else HEIGHT_SIGMA_M])
        quarters = (laid.laying.quarters + scan.plan.rotation_quarters - base.rotation_quarters) % 4
        fmt = scan.scan.recording.format
        parts.append(
            ScanPart(scan.name, scan.path, fmt, int(rows[k]), int(keyframes[k]), quarters, _triple(link), _triple(sigma), laid.words)
        )
    return tuple(parts)


def _triple(values: Array) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])


def _placed(scan: SolvedScan, laid: Laid) -> Array:
    """The keyframes (F, 3) of a solved scan in the first scan's plan frame."""
    position = scan.plan.trajectory.position_m
    return np.column_stack((laid.laying.xy(position[:, :2]), position[:, 2]))


def _odometry(scans: Sequence[SolvedScan], parts: Sequence[ScanPart], k: int) -> Trajectory:
    """A scan's odometry in that of the first one, so that its first keyframe stands where the links put it."""
    recording, first = scans[k].scan.recording, int(scans[k].scan.keyframe[0])
    if k == 0:
        return Trajectory(recording.stamp_ns, recording.position_m, recording.odom_from_sensor)
    base = scans[0]
    anchor = int(base.scan.keyframe[0])
    odom_from_world = base.scan.recording.odom_from_sensor[anchor] @ base.segmented.frames.world_from_sensor[0].T
    own_rotation = quarter_turn(parts[k].quarters) @ scans[k].segmented.frames.world_from_sensor[0]
    turn = odom_from_world @ own_rotation @ recording.odom_from_sensor[first].T
    end = _odometry(scans, parts, k - 1).position_m[int(scans[k - 1].scan.keyframe[-1])]
    start = end + odom_from_world @ np.array(parts[k].link_m)
    position = (recording.position_m - recording.position_m[first]) @ turn.T + start
    return Trajectory(recording.stamp_ns, position, turn @ recording.odom_from_sensor)


def _common_sensor(scans: Sequence[SolvedScan]) -> Sensor:
    """The first scan's sensor with the worst accuracy of all."""
    sensors = [scan.scan.recording.sensor for scan in scans]
    level = [sensor.kind is SensorKind.LASER for sensor in sensors]
    if any(level) and not all(level):
        raise InputError("a level laser and a sensor that sees heights cannot be joined: the laser knows no floor; build them apart")
    known = [sensor.accuracy or UNKNOWN_ACCURACY for sensor in sensors]
    if all(sensor.accuracy is None for sensor in sensors):
        return sensors[0]
    worst = RangeAccuracy(max(a.scale_sigma for a in known), max(a.bias_sigma_m for a in known))
    return replace(sensors[0], accuracy=worst)
