"""Drawing into an office's own template."""

from pathlib import Path

import ezdxf
import numpy as np
import pytest
from typer.testing import CliRunner

from floorplan import writers
from floorplan.cli import app
from floorplan.config import DrawingConfig, ProjectConfig
from floorplan.drawings import Drawing, check_sheet
from floorplan.errors import ConfigError
from floorplan.templates_dir import templates_dir
from floorplan.writers.dxf_template import check_template
from tests.sample_plan import sample_plan


def written(template: Path, path: Path) -> "ezdxf.document.Drawing":
    drawing = DrawingConfig(template=str(template))
    writers.write("dxf", sample_plan(), path, drawing, ProjectConfig(name="Town hall"), writers.SheetFacts("s", "2026-05-04", "x"))
    return ezdxf.readfile(path)


def test_the_shipped_template_is_filled(tmp_path: Path) -> None:
    document = written(templates_dir() / "sheet-A3.dxf", tmp_path / "plan.dxf")
    assert document.audit().errors == []
    block = next(insert for insert in document.paperspace("Sheet").query("INSERT") if insert.dxf.name == "TITLE_BLOCK")
    said = {attribute.dxf.tag: attribute.dxf.text for attribute in block.attribs}
    assert said["PROJECT"] == "Town hall"
    assert said["SCALE"] == "1:100"


def test_an_office_title_block_keeps_its_own_shape(tmp_path: Path) -> None:
    office = ezdxf.new("R2000")
    office.layers.add("A-ANNO-TTLB", color=5)
    block = office.blocks.new("TITLE_BLOCK")
    block.add_circle((10, 10), 3)
    for index, tag in enumerate(("PROJECT", "DATE", "SCALE", "ACCURACY", "LOGO")):
        block.add_attdef(tag, (5, 5 * index), dxfattribs={"height": 2})
    office.saveas(tmp_path / "office.dxf")
    document = written(tmp_path / "office.dxf", tmp_path / "plan.dxf")
    assert document.acad_release == "R2010"
    assert document.layers.get("A-ANNO-TTLB").dxf.color == 5
    assert len(document.blocks.get("TITLE_BLOCK").query("CIRCLE")) == 1
    assert document.audit().errors == []


def test_a_template_without_its_parts_is_refused_by_name(tmp_path: Path) -> None:
    bare = ezdxf.new("R2010")
    bare.saveas(tmp_path / "bare.dxf")
    with pytest.raises(ConfigError, match=r"A-ANNO-TTLB.*TITLE_BLOCK"):
        written(tmp_path / "bare.dxf", tmp_path / "plan.dxf")
    bare.layers.add("A-ANNO-TTLB")
    bare.blocks.new("TITLE_BLOCK").add_attdef("PROJECT", (0, 0))
    bare.saveas(tmp_path / "some.dxf")
    with pytest.raises(ConfigError, match="DATE, SCALE, ACCURACY"):
        written(tmp_path / "some.dxf", tmp_path / "plan.dxf")
    (tmp_path / "text.dxf").write_text("not a drawing")
    for name in ("text.dxf", "missing.dxf"):
        with pytest.raises(ConfigError, match=name):
            written(tmp_path / name, tmp_path / "plan.dxf")
    assert not (tmp_path / "plan.dxf").exists()


def test_the_command_writes_the_shipped_template_and_templates_of_other_sheets(tmp_path: Path) -> None:
    for sheet in ("A3", "ANSI D"):
        result = CliRunner().invoke(app, ["template", str(tmp_path / f"{sheet}.dxf"), "--sheet", sheet])
        assert result.exit_code == 0, result.output
    assert (tmp_path / "A3.dxf").read_bytes() == (templates_dir() / "sheet-A3.dxf").read_bytes()
    check_template(DrawingConfig(template=str(tmp_path / "ANSI D.dxf"), sheet="ANSI D"))
    with pytest.raises(ConfigError, match="851 x 546 mm, beyond the sheet A3"):
        check_template(DrawingConfig(template=str(tmp_path / "ANSI D.dxf")))


def test_a_template_that_lacks_something_is_refused_before_the_build(tmp_path: Path) -> None:
    ezdxf.new("R2010").saveas(tmp_path / "bare.dxf")
    (tmp_path / "scan").mkdir()
    result = CliRunner().invoke(app, ["build", str(tmp_path / "scan"), "--template", str(tmp_path / "bare.dxf")])
    assert isinstance(result.exception, ConfigError)
    assert "floorplan template" in str(result.exception)
    assert not (tmp_path / "scan.floorplan").exists()


def test_a_template_that_owns_blocks_of_our_names_keeps_them(tmp_path: Path) -> None:
    office = ezdxf.readfile(templates_dir() / "sheet-A3.dxf")
    for name in ("DOOR", "ROOM_STAMP", "ROOM_SCHEDULE", "SCALE_AND_NORTH"):
        office.blocks.new(name).add_circle((0, 0), 450)
    office.saveas(tmp_path / "office.dxf")
    document = written(tmp_path / "office.dxf", tmp_path / "plan.dxf")
    assert [entity.dxftype() for entity in document.blocks.get("DOOR")] == ["CIRCLE"]
    ours = {insert.dxf.name for insert in document.modelspace().query("INSERT")}
    assert {"DOOR_2", "ROOM_STAMP_2"} <= ours
    assert not ours & {"DOOR", "ROOM_STAMP"}
    assert document.audit().errors == []


def test_a_drawing_with_a_plan_is_no_template_until_it_is_emptied(tmp_path: Path) -> None:
    own = written(templates_dir() / "sheet-A3.dxf", tmp_path / "own.dxf")
    with pytest.raises(ConfigError, match="delete all in its model space"):
        check_template(DrawingConfig(template=str(tmp_path / "own.dxf")))
    own.modelspace().delete_all_entities()
    own.saveas(tmp_path / "emptied.dxf")
    assert written(tmp_path / "emptied.dxf", tmp_path / "plan.dxf").audit().errors == []


def test_a_scale_the_path_alone_does_not_fit_names_one_it_fits() -> None:
    path = np.array([[0.0, 0.0], [9.0, 0.0], [9.0, 5.0]])
    drawn = (Drawing("png", Path("plan.png")),)
    with pytest.raises(ConfigError, match="use 1:50 or smaller"):
        check_sheet(drawn, DrawingConfig(scale="1:20"), path)
    check_sheet(drawn, DrawingConfig(scale="1:50"), path)
