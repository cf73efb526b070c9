"""Every export of a plan on the site grid lies there; the paper keeps its look."""

import csv
import html
import io
import json
import math
import re
from dataclasses import replace

import ezdxf
import pytest

from floorplan.config import DrawingConfig, ProjectConfig
from floorplan.model.plan import Plan
from floorplan.model.site import Site
from floorplan.plan.plan_json import plan_from_json, plan_to_json
from floorplan.writers import WRITERS, Job, SheetFacts
from tests.sample_plan import sample_plan

SITE = Site(30.0, 691_600.0, 5_334_700.0)


def placed() -> Plan:
    return replace(sample_plan(), site=SITE)


def written(name: str, plan: Plan, units: str = "m") -> bytes:
    facts = SheetFacts("scan", "2026-01-01", "floorplan", 100, 20.0, None, (), (), ())
    return WRITERS[name].make(Job(plan, DrawingConfig(units=units), ProjectConfig(), facts))  # type: ignore[arg-type]


@pytest.mark.parametrize(("units", "per_metre"), [("m", 1.0), ("mm", 1000.0)])
def test_model_space_lies_on_the_grid_and_the_sheets_view_is_turned_back(units: str, per_metre: float) -> None:
    here, there = (ezdxf.read(io.StringIO(written("dxf", plan, units).decode())) for plan in (sample_plan(), placed()))
    assert not there.audit().has_errors
    for before, after in zip(here.modelspace().query("LWPOLYLINE"), there.modelspace().query("LWPOLYLINE"), strict=True):
        for (x, y, *_), (east, north, *_) in zip(before.get_points(), after.get_points(), strict=True):
            expected = SITE.to_site((x / per_metre, y / per_metre))
            assert (east / per_metre, north / per_metre) == pytest.approx(expected, abs=1e-6)
    lengths = [sorted(d.get_measurement() for d in document.modelspace().query("DIMENSION")) for document in (here, there)]
    assert lengths[1] == pytest.approx(lengths[0], rel=1e-7)
    (view,) = [v for v in there.paperspace("Sheet").query("VIEWPORT") if v.dxf.id > 1]
    (plain,) = [v for v in here.paperspace("Sheet").query("VIEWPORT") if v.dxf.id > 1]
    centre = plain.dxf.view_center_point
    assert view.dxf.view_target_point.vec2.isclose(
        ezdxf.math.Vec2(SITE.to_site((centre.x / per_metre, centre.y / per_metre))) * per_metre, abs_tol=1e-3
    )
    assert view.dxf.view_twist_angle == pytest.approx(330.0)
    assert view.dxf.view_height == plain.dxf.view_height


def test_geojson_and_tables_have_site_coordinates() -> None:
    tree = json.loads(written("geojson", placed()))
    assert tree["frame"] == "site grid: east and north"
    first = json.loads(written("geojson", sample_plan()))["features"][0]["geometry"]["coordinates"][0][1]
    assert tree["features"][0]["geometry"]["coordinates"][0][1] == pytest.approx(SITE.to_site((first[0], first[1])), abs=1e-4)
    rows = list(csv.DictReader(io.StringIO(written("dimensions", placed()).decode())))
    assert math.dist(*[(float(rows[0][f"east{k}"]), float(rows[0][f"north{k}"])) for k in (1, 2)]) == pytest.approx(4.0, abs=0.002)
    assert "east" not in written("rooms", sample_plan()).decode()


def test_the_plan_as_data_keeps_its_site() -> None:
    assert plan_from_json(plan_to_json(placed())).site == SITE


def test_the_paper_says_where_it_lies_on_the_grid() -> None:
    corners = [point for room in sample_plan().rooms for point in room.outline]
    east, north = SITE.to_site((min(x for x, _ in corners), min(y for _, y in corners)))
    said = html.unescape(" ".join(re.findall(r">([^<>]+)</text>", written("svg", placed()).decode())))
    assert f"E {east:.3f}, N {north:.3f}" in said
    assert "-30.0000 degrees" in said
    assert "Site grid," not in written("svg", sample_plan()).decode()
