"""The layout graph: odometry rows, measurements, signs, and the exchange file."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from floorplan.errors import InputError
from floorplan.geometry import rotation_about_z
from floorplan.graph_file import load_graph, save_graph
from floorplan.layout_graph import layout_graph, with_signs_from_facing
from floorplan.model.graph import LayoutGraph
from floorplan.model.scan import GravitySource, IngestedScan, NoiseModel, RangeAccuracy, Recording, Sensor, SensorKind
from floorplan.model.segment import EvidencePoints, FreePatches, ManhattanFrames, SegmentedScan, Segments, Tracks
from floorplan.odometry_steps import keyframe_steps, odometry_rows
from tests.graphs import graph_along_x, loop_graph


def scan_of(position: np.ndarray, odom_from_sensor: np.ndarray, keyframe: list[int]) -> IngestedScan:
    sensor = Sensor(SensorKind.LASER, 1, 180, NoiseModel(0.01), 0.1, 30.0, 0.017)
    count = len(position)
    stamp = 5_000_000_000 + 100_000_000 * np.arange(count)
    down = np.tile([0.0, 0, -1], (count, 1))
    return IngestedScan(Recording("test", sensor, stamp, position, odom_from_sensor, down, GravitySource.LEVEL), keyframe)


def segmented_of(world_from_sensor: np.ndarray, rows: list[tuple[int, int, float, float]]) -> SegmentedScan:
    """Segments normal to x from (frame, facing, distance, sigma)."""
    frame, facing, distance, sigma = (np.array(column) for column in zip(*rows, strict=True))
    count, frames = len(rows), len(world_from_sensor)
    ones, zero3 = np.ones(count), np.zeros((count, 3))
    segments = Segments(
        frame, np.zeros(count), facing, distance, sigma, ones, ones, np.zeros((count, 3, 2)), zero3, np.zeros((count, 3, 3))
    )
    none = np.zeros(0)
    patches = FreePatches(none, none, np.zeros((0, 2)), np.zeros((0, 2)), np.zeros((0, 2)), none, none)
    evidence = EvidencePoints(np.zeros(frames + 1), np.zeros((0, 3)), none, none)
    return SegmentedScan(ManhattanFrames(world_from_sensor, np.zeros(frames), np.ones(frames)), segments, patches, evidence)


def test_odometry_steps_are_turned_from_the_odometry_s_world_into_the_axis_aligned_one() -> None:
    # The odometry believes the sensor looks along its x; it really looks along world y: a step ahead is along y.
    odom, world = np.tile(np.eye(3), (2, 1, 1)), np.tile(rotation_about_z(np.array(np.pi / 2)), (2, 1, 1))
    step = odometry_rows(np.array([[0.0, 0, 0], [2.0, 0, 0.5]]), odom, world)
    np.testing.assert_allclose(step, [[0, 2, 0.5]], atol=1e-12)


def test_a_map_is_turned_as_a_whole_and_bent_only_where_frames_differ_by_more_than_their_errors() -> None:
    noise = np.radians([0.4, -0.3, 0.5, -0.5, 0.2, 0.0, 6.0])
    position = np.column_stack((np.arange(7.0), np.zeros((7, 2))))
    world = rotation_about_z(np.radians(30.0) + noise)
    scan = replace(scan_of(position, np.tile(np.eye(3), (7, 1, 1)), list(range(7))), map_sigma_m=np.full(7, 0.02))
    step = keyframe_steps(scan, world)
    heading = np.degrees(np.arctan2(step[:, 1], step[:, 0]))
    np.testing.assert_allclose(heading, np.degrees(np.median(noise)) + 30.0, atol=1e-9)
    free = keyframe_steps(replace(scan, map_sigma_m=None), world)
    np.testing.assert_allclose(np.degrees(np.arctan2(free[:, 1], free[:, 0])), 30.0 + np.degrees(noise[:-1]), atol=1e-9)
    last = keyframe_steps(replace(scan, keyframe=np.array([5, 6])), rotation_about_z(np.radians([30.0, 36.0])))
    assert 30.0 < np.degrees(np.arctan2(last[0, 1], last[0, 0])) < 33.0


def test_rows_join_keyframes_and_pieces_of_one_track_in_one_frame_become_one_row() -> None:
    position = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.3, 0.1, 0], [0.4, 0.1, 0]])
    scan = scan_of(position, np.tile(np.eye(3), (4, 1, 1)), [0, 2, 3])
    rows = [(0, -1, 2.0, 0.01), (0, -1, 2.3, 0.02), (1, -1, 1.7, 0.01), (2, 1, -1.0, 0.01), (2, -1, 9.0, 0.01)]
    segmented = segmented_of(np.tile(np.eye(3), (3, 1, 1)), rows)
    tracks = Tracks([0, 0, 0, 1, -1], [0, 0], [-1, 1], np.zeros((2, 3, 2)))
    graph = layout_graph(scan, segmented, tracks)
    np.testing.assert_allclose(graph.stamp_s, [0, 0.2, 0.3])
    np.testing.assert_allclose(graph.translation_m, [[0.3, 0.1, 0], [0.1, 0, 0]], atol=1e-12)
    assert graph.frame.tolist() == [0, 1, 2]
    assert graph.track.tolist() == [0, 0, 1]
    np.testing.assert_allclose(graph.distance_m, [(2.0 * 4 + 2.3) / 5, 1.7, -1.0])  # weights 1 and 1/4
    assert graph.sigma_m is not None
    np.testing.assert_allclose(graph.sigma_m, [0.01 * np.sqrt(0.8), 0.01, 0.01])


def test_rows_whose_sign_contradicts_their_facing_are_left_out_and_counted() -> None:
    graph = graph_along_x([0.0], [(0, 0, 2.0), (1, 0, -2.0), (0, 1, -1.0)], facing=[-1, 1], sigma_m=[0.1, 0.2, 0.3])
    signed, rejected = with_signs_from_facing(graph)
    assert rejected == 1
    assert signed.distance_m.tolist() == [2.0, -1.0]
    assert signed.sigma_m is not None
    assert signed.sigma_m.tolist() == [0.1, 0.3]


def test_a_track_that_disagrees_altogether_keeps_its_rows_with_the_sign_of_its_facing() -> None:
    signed, rejected = with_signs_from_facing(graph_along_x([0.0], [(0, 0, -2.0), (1, 0, -2.1)], facing=[-1]))
    assert rejected == 2
    assert signed.distance_m.tolist() == [2.0, 2.1]


@pytest.mark.parametrize("accuracy", [None, RangeAccuracy(0.004, 0.002)])
def test_a_graph_survives_its_file(tmp_path: Path, accuracy: RangeAccuracy | None) -> None:
    graph = replace(loop_graph(0)[0], range_accuracy=accuracy, heading_sigma_rad=0.01 if accuracy else 0.0)
    save_graph(graph, tmp_path / "graph.npz")
    again = load_graph(tmp_path / "graph.npz")
    for name in LayoutGraph.__dataclass_fields__:
        if getattr(graph, name) is None or name == "range_accuracy":
            assert getattr(again, name) == getattr(graph, name)
        else:
            np.testing.assert_array_equal(getattr(again, name), getattr(graph, name))


def arrays() -> dict[str, np.ndarray]:
    return {
        "stamp": np.arange(2.0),
        "translation": np.zeros((1, 3)),
        "frame": np.array([0, 1]),
        "track": np.array([0, 0]),
        "distance": np.array([1.0, 1.1]),
        "axis": np.array([0]),
        "facing": np.array([-1]),
        "extent": np.full((1, 3, 2), np.nan),
    }


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("distance", None, "'distance' is missing"),
        ("translation", np.zeros((3, 3)), r"'translation' has shape \(3, 3\), expected \(1, 3\)"),
        ("frame", np.array([0, 2]), r"'frame', row 1: out of range 0\.\.1"),
        ("track", np.array([0, -1]), r"'track', row 1: out of range 0\.\.0"),
        ("axis", np.array([3]), "not 0, 1 or 2"),
        ("facing", np.array([0]), r"not \+1 or -1"),
        ("distance", np.array([1.0, np.nan]), "'distance' is not finite at row 1"),
        ("stamp", np.array([1.0, 0.0]), "'stamp', row 1: earlier"),
        ("sigma", np.array([0.1, 0.0]), "'sigma', row 1: not positive"),
        ("sigma", np.array([0.1]), "'sigma' has shape"),
        ("frame", np.array([0.5, 1.0]), "whole numbers"),
        ("facing", np.array(["a"]), "expected numbers"),
        ("stamp", np.zeros(0), "at least one frame"),
    ],
)
def test_a_bad_graph_file_is_refused_with_the_array_and_the_row(tmp_path: Path, name: str, value: np.ndarray | None, message: str) -> None:
    contents = arrays() | {name: value} if value is not None else {k: v for k, v in arrays().items() if k != name}
    np.savez(tmp_path / "graph.npz", **contents)
    with pytest.raises(InputError, match=message):
        load_graph(tmp_path / "graph.npz")


def test_a_track_without_measurements_is_refused(tmp_path: Path) -> None:
    contents = arrays() | {"axis": np.zeros(2), "facing": np.ones(2), "extent": np.zeros((2, 3, 2))}
    np.savez(tmp_path / "graph.npz", **contents)
    with pytest.raises(InputError, match="track 1: without any measurement"):
        load_graph(tmp_path / "graph.npz")


def test_a_file_that_is_no_graph_is_refused(tmp_path: Path) -> None:
    (tmp_path / "graph.npz").write_text("nothing of the kind")
    with pytest.raises(InputError, match="not a layout graph"):
        load_graph(tmp_path / "graph.npz")
    with pytest.raises(InputError, match="not a layout graph"):
        load_graph(tmp_path / "missing.npz")
