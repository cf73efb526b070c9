"""A walk over two floors gives a drawing for each: simulated, built, written."""

import json
from pathlib import Path

import pytest
from shapely.geometry import Polygon

from floorplan.build import Job, build
from floorplan.drawings import Drawing
from floorplan.errors import UsageError
from floorplan.model.plan import Plan
from floorplan.plan.plan_json import plan_from_json
from floorplan.simulate import simulate
from floorplan.simulate.scene import draw_scene


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the scan `two` of a flat on two floors, built, and its drawings."""
    folder = tmp_path_factory.mktemp("storeys")
    simulate(folder / "two", "flat", 1, rate_hz=3.0, image_scale=0.3, storeys=2)
    names = {"dxf": "plan.dxf", "svg": "plan.svg", "geojson": "plan.geojson", "dimensions": "dimensions.csv", "report": "plan.html"}
    drawings = tuple(Drawing(format, folder / name) for format, name in names.items())
    assert build(Job(folder / "two", folder / "work", drawings=drawings)) is not None
    return folder


def read_plan(built: Path) -> Plan:
    return plan_from_json((built / "work" / "plan.json").read_text("utf-8"))


def test_the_second_floor_lies_where_it_was_built(built: Path) -> None:
    truth = json.loads((built / "two" / "truth.json").read_text("utf-8"))
    first, second = read_plan(built).storeys
    assert first.elevation_m == 0.0
    assert second.elevation_m == pytest.approx(truth["storeys"][1]["floor_m"], abs=0.02)
    assert (first.level, second.level) == ("Storey 1", "Storey 2")
    assert second.trajectory.position_m[-1, 2] == pytest.approx(1.5, abs=0.15)


def test_every_storey_has_its_visited_rooms(built: Path) -> None:
    truth = json.loads((built / "two" / "truth.json").read_text("utf-8"))
    for storey, true in zip(read_plan(built).storeys, truth["storeys"], strict=True):
        visited = [Polygon(space["outline"]).area for space in true["spaces"] if space["visited"]]
        areas = sorted(room.area_m2 for room in storey.rooms if room.visited)
        assert areas == pytest.approx(sorted(visited), rel=0.03)


def test_ids_are_unique_over_the_building_and_planes_are_shared(built: Path) -> None:
    first, second = read_plan(built).storeys
    for things in ("rooms", "walls", "openings", "dimensions"):
        assert not {t.id for t in getattr(first, things)} & {t.id for t in getattr(second, things)}
    assert [p.id for p in first.planes] == [p.id for p in second.planes]


def test_drawings_are_one_file_per_storey_and_tables_one_for_all(built: Path) -> None:
    assert {path.name for path in built.iterdir() if path.is_file()} == {
        *("plan-1.dxf", "plan-2.dxf", "plan-1.svg", "plan-2.svg", "plan.geojson", "dimensions.csv", "plan.html")
    }
    features = json.loads((built / "plan.geojson").read_text("utf-8"))["features"]
    assert {feature["properties"]["storey"] for feature in features} == {"Storey 1", "Storey 2"}
    lines = (built / "dimensions.csv").read_text("utf-8").splitlines()
    assert lines[0].startswith("storey,id,")
    assert len(lines) - 1 == sum(len(storey.dimensions) for storey in read_plan(built).storeys)
    assert (built / "plan.html").read_text("utf-8").count("<svg") == 2


def test_the_simulated_stair_is_climbed_without_a_jump() -> None:
    scene = draw_scene("flat", 1, storeys=2)
    height = scene.walk.position_m[:, 2]
    assert abs(height[1:] - height[:-1]).max() < 0.1
    assert height[-1] - height[0] == pytest.approx(scene.storeys[1].floor_m, abs=0.05)
    assert (scene.walk.stamp_ns[1:] > scene.walk.stamp_ns[:-1]).all()


def test_a_robot_cannot_climb(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="climbs no stairs"):
        simulate(tmp_path / "out", "flat", 1, format="carmen", storeys=2)
