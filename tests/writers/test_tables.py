"""GeoJSON, CSV tables and the HTML page."""

import csv
import io
import json
from pathlib import Path

import pytest
from shapely.geometry import shape

from floorplan import writers
from floorplan.config import DrawingConfig, ProjectConfig
from tests.sample_plan import sample_plan

PLAN = sample_plan()


def written(name: str, folder: Path) -> str:
    path = folder / name
    facts = writers.SheetFacts("sample", problems=("frame 3: unreadable (1)",), path_m=28.4, rows=(writers.FactRow("Planes", "6"),))
    writers.write(name, PLAN, path, DrawingConfig(), ProjectConfig(name="A & B <co>"), facts)
    return path.read_text("utf-8")


def test_geojson_rooms_are_valid_polygons_with_holes_in_plan_metres(tmp_path: Path) -> None:
    collection = json.loads(written("geojson", tmp_path))
    rooms = [feature for feature in collection["features"] if feature["properties"]["kind"] == "room"]
    assert len(rooms) == len(PLAN.rooms)
    corridor = shape(next(room["geometry"] for room in rooms if room["id"] == "R4"))
    assert corridor.is_valid
    assert len(corridor.interiors) == 1
    assert corridor.area == pytest.approx(13.4 * 4.18 - 8.8 * 0.9, abs=1e-3)
    assert len({feature["id"] for feature in collection["features"]}) == len(collection["features"])


def test_the_dimension_table_has_an_empty_column_to_fill_on_site(tmp_path: Path) -> None:
    rows = list(csv.DictReader(io.StringIO(written("dimensions", tmp_path))))
    assert [row["id"] for row in rows] == [dimension.id for dimension in PLAN.dimensions]
    for row, dimension in zip(rows, PLAN.dimensions, strict=True):
        assert float(row["plan_m"]) == pytest.approx(dimension.distance_m, abs=1e-4)
        assert float(row["plus_minus_95_m"]) == pytest.approx(1.96 * dimension.sigma_m, abs=1e-4)
        assert row["measured_m"] == ""


def test_the_room_table_leaves_unknown_heights_empty(tmp_path: Path) -> None:
    rows = list(csv.DictReader(io.StringIO(written("rooms", tmp_path))))
    assert [row["number"] for row in rows] == [room.id for room in PLAN.rooms]
    assert rows[0]["ceiling_height_m"] == "2.642"
    assert rows[5]["ceiling_height_m"] == ""
    assert rows[5]["partial"] == "yes"


def test_the_page_stands_alone_and_says_what_went_wrong(tmp_path: Path) -> None:
    page = written("report", tmp_path)
    for outside in ("http://", "https://", "src=", "<link", "<script"):
        assert outside not in page.replace("http://www.w3.org/2000/svg", "")
    assert "<svg" in page
    assert "A &amp; B &lt;co&gt;" in page
    for word in ("frame 3: unreadable (1)", "seen over the top", "28.400 m", "D19", "prefers-color-scheme: dark"):
        assert word in page
