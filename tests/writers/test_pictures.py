"""SVG, PDF and PNG of the sheet."""

import io
import re
import struct
from pathlib import Path
from xml.etree import ElementTree

import pytest
from PIL import Image

from floorplan import writers
from floorplan.config import DrawingConfig, ProjectConfig
from floorplan.errors import ConfigError, UsageError
from tests.sample_plan import X0, X5, sample_plan

SVG = "{http://www.w3.org/2000/svg}"
FACTS = writers.SheetFacts("sample", "2026-05-04", "floorplan 0.1.0")


def written(path: Path, **drawing: str) -> bytes:
    writers.write(path.suffix[1:], sample_plan(), path, DrawingConfig(**drawing), ProjectConfig(name="Łódź & <Sons>"), FACTS)
    return path.read_bytes()


def test_an_svg_wall_is_as_long_on_paper_as_the_scale_says(tmp_path: Path) -> None:
    for sheet, scale, size in (("A3", 100, ("420mm", "297mm")), ("A2", 50, ("594mm", "420mm"))):
        root = ElementTree.fromstring(written(tmp_path / "plan.svg", sheet=sheet))
        assert (root.get("width"), root.get("height")) == size
        assert root.get("viewBox") == f"0 0 {size[0][:-2]} {size[1][:-2]}"
        walls = next(group for group in root.iter(f"{SVG}g") if group.get("id") == "A-WALL")
        first = [float(x) for x, _ in re.findall(r"([\d.]+),([\d.]+)", walls[0].get("d"))]
        assert max(first) - min(first) == pytest.approx((X5 - X0 + 0.6) * 1000 / scale, abs=0.01)


def test_the_svg_escapes_what_people_write(tmp_path: Path) -> None:
    root = ElementTree.fromstring(written(tmp_path / "plan.svg"))
    texts = [text.text for text in root.iter(f"{SVG}text")]
    assert "Łódź & <Sons>" in texts
    assert any(text and text.startswith("D1  4.000 m ±0.012") for text in texts)


def test_pictures_are_the_same_bytes_for_the_same_plan(tmp_path: Path) -> None:
    for name in ("plan.svg", "plan.pdf", "plan.png"):
        assert written(tmp_path / name, sheet="A4") == written(tmp_path / name, sheet="A4")


def test_the_pdf_page_has_the_size_of_the_sheet(tmp_path: Path) -> None:
    box = re.search(rb"/MediaBox \[ ?0 0 ([\d.]+) ([\d.]+)", written(tmp_path / "plan.pdf", sheet="A3"))
    assert box is not None
    assert [float(side) / 72 * 25.4 for side in box.groups()] == pytest.approx([420, 297], abs=0.1)


def test_the_png_is_small_and_its_paper_white(tmp_path: Path) -> None:
    content = written(tmp_path / "plan.png", sheet="A3")
    assert len(content) < 250_000
    with Image.open(io.BytesIO(content)) as picture:
        pixels = picture.convert("RGB")
    assert pixels.getpixel((2, 2)) == (255, 255, 255)
    colours = {colour for _, colour in pixels.getcolors(256) or ()}
    assert min(max(colour) for colour in colours) < 40  # the frame's black
    assert any(blue > red + 80 for red, _, blue in colours)  # glass, the rarest ink


def test_the_png_has_the_proportions_of_the_sheet(tmp_path: Path) -> None:
    width, height = struct.unpack(">II", written(tmp_path / "plan.png", sheet="A4")[16:24])
    assert width / height == pytest.approx(297 / 210, abs=0.002)
    assert width == pytest.approx(297 / 25.4 * 200, abs=1)


def test_feet_and_inches_are_written_as_builders_read_them(tmp_path: Path) -> None:
    text = written(tmp_path / "plan.svg", units="ft").decode()
    assert "D1  13&#x27;-1 1/2&quot; ±1/2&quot;" in text
    assert "sq ft" in text
    assert "1:96" in text


@pytest.mark.parametrize(
    ("setting", "value", "says"),
    [
        ("scale", "1:20", "use 1:100"),
        ("scale", "half", "1:50"),
        ("sheet", "A9", "ANSI B"),
        ("units", "cm", "mm"),
        ("layers", "din", "iso13567"),
        ("profile", "bim", "cafm"),
    ],
)
def test_a_setting_that_cannot_be_used_says_what_can(tmp_path: Path, setting: str, value: str, says: str) -> None:
    with pytest.raises(ConfigError, match=re.escape(says)):
        written(tmp_path / "plan.svg", **{setting: value})


def test_an_unknown_format_names_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="dxf, svg, pdf"):
        written(tmp_path / "plan.dwg")
    assert list(tmp_path.iterdir()) == []
