"""A finished sample in three dimensions: its points stand on their planes, and the picture shows them without a screen."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from floorplan.build import Job, build
from floorplan.export import read_results
from floorplan.placed_points import placed_points, points_on_segments, turned_axes
from floorplan.results import Results, trajectories
from floorplan.view import make_scene
from floorplan.view.picture import HEIGHT, WIDTH, Camera
from floorplan.view.scene import AXIS_COLOURS, outline
from floorplan.write_view import read_scene, write_screenshot

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "flat"


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("view") / "work"
    build(Job(SAMPLE, folder))
    return folder


@pytest.fixture(scope="module")
def results(work: Path) -> Results:
    return read_results(work)


def test_points_of_an_axis_lie_on_planes_of_that_axis_and_facing(results: Results) -> None:
    placed = placed_points(results, trajectories(results).final, points_on_segments(results, 20_000))
    for axis in range(3):
        for facing in (-1, 1):
            offsets = np.array([p.offset_m for p in results.plan.planes if (p.axis, p.facing) == (axis, facing)])
            rows = (placed.axis == axis) & (placed.facing == facing)
            if len(offsets) and rows.sum() > 100:
                apart = np.abs(placed.point_m[rows, axis][:, None] - offsets).min(axis=1)
                assert np.median(apart) < 0.02
                assert np.mean(apart < 0.06) > 0.9


def test_four_quarter_turns_change_nothing_and_one_takes_plus_x_to_plus_y() -> None:
    axis, facing = np.array([0, 1, 2, 0]), np.array([1, 1, -1, -1])
    assert [list(values) for values in turned_axes(axis, facing, 1)] == [[1, 0, 2, 1], [1, -1, -1, -1]]
    assert [list(values) for values in turned_axes(axis, facing, 4)] == [list(axis), list(facing)]


def test_the_scene_has_dotted_planes_in_their_colours_and_both_paths(results: Results) -> None:
    scene = make_scene(results, ceilings=True)
    dotted = [line for line in scene.lines if line.dotted]
    assert len(dotted) == len(results.plan.planes)
    assert {line.colour for line in dotted} == set(AXIS_COLOURS)
    assert [len(line.points_m) for line in scene.lines[-2:]] == [len(results.scan.recording)] * 2
    assert len(make_scene(results).points_m) < len(scene.points_m)  # ceilings are left out unless asked for


def test_an_outline_lies_in_its_plane_and_spans_its_extent(results: Results) -> None:
    plane = results.plan.planes[0]
    corners = outline(plane)
    assert (corners[:, plane.axis] == plane.offset_m).all()
    spans = [plane.extent_m[axis] for axis in range(3) if axis != plane.axis]
    assert np.prod([high - low for low, high in spans]) == pytest.approx(_area(np.delete(corners, plane.axis, axis=1)))


def _area(ring: np.ndarray) -> float:
    x, y = ring[:, 0], ring[:, 1]
    return abs(float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum())) / 2


@pytest.mark.parametrize("above", [False, True])
def test_a_screenshot_needs_no_screen_and_shows_walls_floor_and_path(work: Path, tmp_path: Path, above: bool) -> None:
    write_screenshot(read_scene(work), tmp_path / "view.png", above)
    image = cv2.imread(str(tmp_path / "view.png"))[..., ::-1].astype(int)
    assert image.shape == (HEIGHT, WIDTH, 3)
    drawn = (image < 250).any(axis=2)
    assert (0.04 if above else 0.1) < drawn.mean() < 0.95  # from above walls are lines
    edge = np.concatenate((drawn[0], drawn[-1], drawn[:, 0], drawn[:, -1]))
    assert edge.mean() < 0.1  # framed, not cut off
    for colour in (*AXIS_COLOURS, (0, 0, 0)):
        assert 0.0005 < (np.abs(image - colour).max(axis=2) < 30).mean() < 0.6


def test_from_above_walls_stand_upright() -> None:
    column = np.array([[3.0, 2.0, 0.0], [3.0, 2.0, 2.5]])
    parallel = Camera(np.eye(3), np.zeros(3), 20.0, 100.0, parallel=True).project(column)[0]
    np.testing.assert_allclose(parallel[0], parallel[1])
    eye = Camera(np.eye(3), np.zeros(3), 20.0, 100.0).project(column)[0]
    assert 1.0 < np.linalg.norm(eye[1] - eye[0]) < 5.0
