"""Which topics of a bag hold ranges, the camera's intrinsics and poses: chosen by type, or named in the settings."""

from dataclasses import dataclass
from pathlib import Path

from floorplan.config import ReadConfig
from floorplan.errors import InputError
from floorplan.readers.ros_bag import Topic, messages

IMAGE = "sensor_msgs/msg/Image"
COMPRESSED_IMAGE = "sensor_msgs/msg/CompressedImage"
LASER_SCAN = "sensor_msgs/msg/LaserScan"
POINT_CLOUD = "sensor_msgs/msg/PointCloud2"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"
IMU = "sensor_msgs/msg/Imu"
TF = "tf2_msgs/msg/TFMessage"
OLD_TF = "tf/msg/tfMessage"
ODOMETRY = "nav_msgs/msg/Odometry"
POSE_TYPES = (
    ODOMETRY,
    "geometry_msgs/msg/PoseStamped",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "geometry_msgs/msg/TransformStamped",
)
DEPTH_ENCODINGS = ("16UC1", "mono16", "32FC1")
RANGE = "--topic depth=NAME (read.range_topic)"
IMU_TOPIC = "--topic imu=NAME (read.imu_topic)"
POSE = "--topic pose=NAME (read.pose_topic)"
DEPTH_PNG = "compressedDepth"  # the transport that writes PNGs after a header


@dataclass(frozen=True)
class ChosenTopics:
    """`ranges` depth images, sweeps or clouds; `camera_info` for depth images; `pose` None where poses come from `tf`; `imu` if any."""

    ranges: Topic
    camera_info: Topic | None
    pose: Topic | None
    tf: tuple[str, ...]
    imu: Topic | None = None


def choose_topics(paths: tuple[Path, ...], topics: tuple[Topic, ...], config: ReadConfig) -> ChosenTopics:
    """The topics to read. Raises `InputError` that lists what there is when none or several would do."""
    bag, holding = paths[0], [t for t in topics if config.range_topic or _holds_ranges(paths, t)]
    ranges = _one(bag, topics, holding, config.range_topic, RANGE, "depth images, sweeps or clouds")
    tf = tuple(t.name for t in topics if t.type in (TF, OLD_TF))
    poses = [t for t in topics if t.type in POSE_TYPES and t.count]
    odometry = [t for t in poses if t.type == ODOMETRY]
    pose = None
    if config.pose_topic or poses or not tf:
        candidates = odometry if len(odometry) == 1 else poses
        pose = _one(bag, topics, candidates, config.pose_topic, POSE, "poses (Odometry, PoseStamped, tf)")
    imus = [t for t in topics if t.type == IMU and t.count]
    imu = _one(bag, topics, imus, config.imu_topic, IMU_TOPIC, "accelerations") if config.imu_topic else _nearest(imus, ranges)
    info = _nearest([t for t in topics if t.type == CAMERA_INFO and t.count], ranges) if ranges.type in (IMAGE, COMPRESSED_IMAGE) else None
    return ChosenTopics(ranges, info, pose, tf, imu)


def _holds_ranges(paths: tuple[Path, ...], topic: Topic) -> bool:
    """True for sweeps, clouds, and images whose first message is depth."""
    if topic.type in (LASER_SCAN, POINT_CLOUD):
        return topic.count > 0
    if topic.type not in (IMAGE, COMPRESSED_IMAGE):
        return False
    first = next(messages(paths, {topic.name}), None)
    if first is None:
        return False
    return first.value.encoding in DEPTH_ENCODINGS if topic.type == IMAGE else DEPTH_PNG in first.value.format


def _one(path: Path, topics: tuple[Topic, ...], candidates: list[Topic], wanted: str, setting: str, what: str) -> Topic:
    if wanted:
        named = [t for t in topics if t.name == wanted]
        if named:
            return named[0]
        raise InputError(f"{path}: no topic {wanted}; {setting} must be one of: {_list(topics)}")
    if len(candidates) == 1:
        return candidates[0]
    if candidates:
        raise InputError(f"{path}: several topics hold {what}: {_list(tuple(candidates))}; choose one with {setting}")
    raise InputError(f"{path}: no topic holds {what}; the bag has: {_list(topics) or 'no topics at all'}")


def _list(topics: tuple[Topic, ...]) -> str:
    return ", ".join(f"{t.name} ({t.type}, {t.count})" for t in topics)


def _nearest(candidates: list[Topic], ranges: Topic) -> Topic | None:
    """The topic whose name shares most with the ranges' name: what belongs together is published side by side."""
    return max(candidates, key=lambda t: _shared(t.name, ranges.name), default=None)


def _shared(first: str, second: str) -> int:
    parts = list(zip(first.split("/"), second.split("/"), strict=False))
    same = [a == b for a, b in parts]
    return same.index(False) if False in same else len(same)
