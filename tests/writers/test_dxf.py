"""The DXF drawing, read back with ezdxf."""

from collections import Counter, defaultdict
from pathlib import Path

import ezdxf
import pytest

from floorplan import writers
from floorplan.config import DrawingConfig, ProjectConfig
from floorplan.model.plan import Plan
from floorplan.writers.composition import DXF_VERSIONS
from floorplan.writers.layers import Layer, layer_styles
from tests.sample_plan import sample_plan

PROJECT = ProjectConfig(name="Sample building", floor="Ground floor", north_deg=20.0)
FACTS = writers.SheetFacts("sample", "2026-05-04", "floorplan 0.1.0")


@pytest.fixture(scope="module")
def plan() -> Plan:
    return sample_plan()


def written(plan: Plan, path: Path, **drawing: str) -> "ezdxf.document.Drawing":
    writers.write("dxf", plan, path, DrawingConfig(**drawing), PROJECT, FACTS)
    return ezdxf.readfile(path)


@pytest.mark.parametrize("version", DXF_VERSIONS)
def test_every_version_is_audit_clean_and_reads_back(plan: Plan, tmp_path: Path, version: str) -> None:
    document = written(plan, tmp_path / "plan.dxf", dxf_version=version)
    audit = document.audit()
    assert document.acad_release == version
    assert audit.errors == []
    assert audit.fixes == []
    points = [point for line in document.modelspace().query('*[layer=="A-WALL"]') for point in line.get_points("xy")]
    wanted = [point for wall in plan.walls for line in wall.seen for point in (line[:-1] if line[0] == line[-1] else line)]
    wanted += [point for line in plan.free_lines for point in (line.start, line.end)]
    assert sorted(points) == [pytest.approx(point, abs=1e-4) for point in sorted(wanted)]
    drawn = document.modelspace().query("DIMENSION")
    assert len(drawn) == sum(dimension.axis < 2 for dimension in plan.dimensions)


def test_the_same_plan_gives_the_same_bytes(plan: Plan, tmp_path: Path) -> None:
    written(plan, tmp_path / "a.dxf")
    written(plan, tmp_path / "b.dxf")
    assert (tmp_path / "a.dxf").read_bytes() == (tmp_path / "b.dxf").read_bytes()


def test_walls_come_back_to_a_tenth_of_a_millimetre_and_alone_on_their_layer(plan: Plan, tmp_path: Path) -> None:
    for units, per_metre in (("m", 1.0), ("mm", 1000.0), ("ft", 1 / 0.3048)):
        document = written(plan, tmp_path / "plan.dxf", units=units)
        lines = document.modelspace().query('*[layer=="A-WALL"]')
        assert {line.dxftype() for line in lines} == {"LWPOLYLINE"}
        drawn = sorted(tuple((x / per_metre, y / per_metre) for x, y in line.get_points("xy")) for line in lines)
        wanted = [line[:-1] if line[0] == line[-1] else line for wall in plan.walls for line in wall.seen]
        wanted += [(line.start, line.end) for line in plan.free_lines]
        assert len(drawn) == len(wanted)
        for got, want in zip(drawn, sorted(wanted), strict=True):
            for point, truth in zip(got, want, strict=True):
                assert point == pytest.approx(truth, abs=1e-4)


def test_only_outlines_that_end_where_they_began_are_closed(plan: Plan, tmp_path: Path) -> None:
    lines = written(plan, tmp_path / "plan.dxf").modelspace().query('*[layer=="A-WALL"]')
    assert sum(line.closed for line in lines) == sum(line[0] == line[-1] for wall in plan.walls for line in wall.seen)
    assert any(not line.closed for line in lines)


def test_every_layer_of_the_design_is_there_with_its_pen(plan: Plan, tmp_path: Path) -> None:
    document = written(plan, tmp_path / "plan.dxf")
    for layer in Layer:
        assert layer.value in document.layers
    assert document.layers.get("A-WALL").dxf.lineweight == 50
    assert document.layers.get("A-WALL-INFR").dxf.linetype == "DASHED"
    for name in ("V-PATH", "V-PNTS"):
        assert document.layers.get(name).is_off()
        assert document.layers.get(name).dxf.plot == 0


def test_everything_in_model_space_is_flat(plan: Plan, tmp_path: Path) -> None:
    for entity in written(plan, tmp_path / "plan.dxf").modelspace():
        if entity.dxftype() in ("LWPOLYLINE", "HATCH"):
            elevation = entity.dxf.get("elevation", 0.0)
            assert (elevation if isinstance(elevation, float) else elevation[2]) == 0.0
        else:
            point = entity.dxf.get({"DIMENSION": "defpoint", "POINT": "location"}.get(entity.dxftype(), "insert"))
            assert point[2] == 0.0


def test_doors_carry_their_width_and_stand_in_their_opening(plan: Plan, tmp_path: Path) -> None:
    inserts = written(plan, tmp_path / "plan.dxf").modelspace().query('INSERT[layer=="A-DOOR"]')
    openings = {o.id: o for o in plan.openings if o.kind != "window"}
    assert len(inserts) == len(openings)
    assert Counter(insert.dxf.name for insert in inserts) == {"DOOR": 5, "PASSAGE": 1}
    for insert in inserts:
        opening = openings[next(tag.value for tag in insert.get_xdata("FLOORPLAN") if tag.code == 1000)]
        assert float(insert.get_attrib_text("WIDTH")) == pytest.approx(opening.width_m, abs=5e-4)
        assert insert.dxf.xscale == pytest.approx(opening.width_m)
        assert tuple(insert.dxf.insert)[:2] == pytest.approx(opening.centre)
        assert insert.dxf.rotation % 180 == 90 * opening.along_axis


def test_room_outlines_are_closed_and_enclose_the_net_area(plan: Plan, tmp_path: Path) -> None:
    from shapely import Polygon

    lines = written(plan, tmp_path / "plan.dxf").modelspace().query('*[layer=="A-AREA"]')
    assert len(lines) == len(plan.rooms)
    for line, room in zip(lines, plan.rooms, strict=True):
        points = [(x, y) for x, y in line.get_points("xy")]
        shoelace = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(points, points[1:] + points[:1], strict=True)) / 2
        assert line.closed
        assert shoelace == pytest.approx(Polygon(room.outline, room.holes).area, abs=1e-6)


def test_dimensions_are_numbered_measure_what_they_say_and_have_their_own_style(plan: Plan, tmp_path: Path) -> None:
    dimensions = written(plan, tmp_path / "plan.dxf").modelspace().query("DIMENSION")
    drawn = [dimension for dimension in plan.dimensions if dimension.role != "height"]
    assert len(dimensions) == len(drawn)
    for entity, dimension in zip(dimensions, drawn, strict=True):
        assert entity.dxf.layer == "A-ANNO-DIMS"
        assert entity.dxf.dimstyle == "FLOORPLAN"
        assert entity.dxf.text == f"{dimension.id}  {dimension.distance_m:.3f} m ±{1.96 * dimension.sigma_m:.3f}"
        assert entity.get_measurement() == pytest.approx(dimension.distance_m, abs=1e-4)


def test_the_sheet_is_to_scale_and_its_title_block_is_filled(plan: Plan, tmp_path: Path) -> None:
    for units, per_metre in (("m", 1.0), ("mm", 1000.0)):
        paper = written(plan, tmp_path / "plan.dxf", units=units, sheet="A2").paperspace("Sheet")
        viewport = next(v for v in paper.query("VIEWPORT") if v.dxf.id != 1)
        assert viewport.dxf.view_height / viewport.dxf.height == pytest.approx(0.05 * per_metre)
        block = next(i for i in paper.query("INSERT") if i.dxf.name == "TITLE_BLOCK")
        said = {a.dxf.tag: a.dxf.text for a in block.attribs}
        assert said["PROJECT"] == "Sample building"
        assert said["SCALE"] == "1:50"
        assert said["DATE"] == "2026-05-04"
        assert "12 mm" in said["ACCURACY"]


def test_the_cafm_profile_has_one_kind_of_entity_per_layer_and_no_hatches(plan: Plan, tmp_path: Path) -> None:
    document = written(plan, tmp_path / "plan.dxf", profile="cafm", units="mm")
    kinds = defaultdict(set)
    for space in (document.modelspace(), document.paperspace("Sheet")):
        for entity in space:
            if entity.dxftype() != "VIEWPORT":
                kinds[entity.dxf.layer].add(entity.dxftype())
    assert document.acad_release == "R2000"
    assert document.header["$INSUNITS"] == 6
    assert all(len(types) == 1 for types in kinds.values()), kinds
    assert "HATCH" not in {kind for types in kinds.values() for kind in types}
    assert document.audit().errors == []


def test_iso_13567_names_replace_the_us_ones(plan: Plan, tmp_path: Path) -> None:
    document = written(plan, tmp_path / "plan.dxf", layers="iso13567")
    names = {style.name for style in layer_styles("iso13567").values()}
    assert len(names) == len(Layer)
    used = {entity.dxf.layer for entity in document.modelspace()}
    assert used <= names
    assert "A-22----E-" in used
    assert "A-WALL" not in document.layers
