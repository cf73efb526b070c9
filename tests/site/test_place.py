"""The plan on the site grid: found again from its corners, honest about misses, refused where the points cannot be meant."""

import contextlib
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from floorplan.config import Config, SiteConfig
from floorplan.corrections import with_site
from floorplan.errors import InputError, UsageError
from floorplan.model.site import Site
from floorplan.site import on_site
from floorplan.site.control import ControlRow, parse_control, read_control
from floorplan.site.place import placed_by
from floorplan.templates_dir import templates_dir
from tests.sample_plan import X5, Y1, Y5, sample_plan

TRUE = Site(31.7, 691_600.0, 5_334_700.0)
CORNERS = ((0.0, 0.0), (X5, 0.0), (4.0, Y1), (0.0, Y5))


def rows(site: Site = TRUE, noise_m: float = 0.0, scale: float = 1.0, eye_m: float = 0.0) -> tuple[ControlRow, ...]:
    """The corners with their true site coordinates; `eye_m`: how badly they are pointed at in the plan."""
    rng = np.random.default_rng(3)
    found = []
    for name, corner in zip("ABCD", CORNERS, strict=True):
        east, north = np.array(site.to_site((scale * corner[0], scale * corner[1]))) + rng.normal(size=2) * noise_m
        shown = corner[0] + eye_m, corner[1] - eye_m
        found.append(ControlRow(name, shown, (float(east), float(north)), snap=True))
    return tuple(found)


def test_turn_and_shift_are_found_and_points_by_eye_snap_to_their_corners() -> None:
    site = placed_by(sample_plan(), rows(eye_m=-0.04))
    assert site.rotation_deg == pytest.approx(31.7, abs=1e-6)
    assert (site.east_m, site.north_m) == (pytest.approx(TRUE.east_m, abs=1e-6), pytest.approx(TRUE.north_m, abs=1e-6))
    assert all(point.snapped and point.miss_m < 1e-6 for point in site.points)
    assert site.scale == pytest.approx(1.0, abs=1e-9)
    assert site.warnings == ()
    assert not any(point.snapped for point in placed_by(sample_plan(), tuple(replace(row, snap=False) for row in rows())).points)


def test_residuals_are_those_of_the_noise_and_the_scale_is_told_only_when_it_is_sure() -> None:
    noisy = placed_by(sample_plan(), rows(noise_m=0.01))
    assert 0.001 < math.sqrt(np.mean([point.miss_m**2 for point in noisy.points])) < 0.02
    assert noisy.warnings == ()
    scaled = placed_by(sample_plan(), rows(noise_m=0.005, scale=1.01))
    assert scaled.scale == pytest.approx(1.01, abs=0.003)
    assert scaled.scale_sigma is not None
    assert 0.0001 < scaled.scale_sigma < 0.003
    assert any("scale" in warning for warning in scaled.warnings)


def test_a_mistyped_point_is_named() -> None:
    wrong = list(rows())
    wrong[2] = replace(wrong[2], site=(wrong[2].site[0] + 1.0, wrong[2].site[1]))
    site = placed_by(sample_plan(), tuple(wrong))
    assert ["control point C" in warning for warning in site.warnings] == [True]
    assert "missed by 1.000 m" in site.warnings[0]
    assert site.rotation_deg == pytest.approx(31.7, abs=1e-6)  # it is left out
    assert [point.miss_m < 1e-6 for point in site.points] == [True, True, False, True]


def test_a_point_that_is_a_little_off_is_told_and_kept() -> None:
    wrong = list(rows())
    wrong[1] = replace(wrong[1], site=(wrong[1].site[0] + 0.1, wrong[1].site[1]))
    site = placed_by(sample_plan(), tuple(wrong))
    assert len(site.warnings) == 1
    assert "control point B" in site.warnings[0]
    assert "left out" not in site.warnings[0]
    assert 0.001 < abs(site.rotation_deg - 31.7) < 2.0


def test_points_that_miss_by_metres_and_blame_no_one_are_refused() -> None:
    wrong = list(rows())
    wrong[0], wrong[2] = replace(wrong[0], site=wrong[2].site), replace(wrong[2], site=wrong[0].site)
    with pytest.raises(InputError, match="missed by up to"):
        placed_by(sample_plan(), tuple(wrong))


def test_a_north_angle_beside_control_points_is_told_where_it_differs() -> None:
    assert placed_by(sample_plan(), rows(), north_deg=-31.5).warnings == ()
    assert placed_by(sample_plan(), rows(), north_deg=360 - 31.5).warnings == ()
    assert "north at 30 degrees is not used" in placed_by(sample_plan(), rows(), north_deg=30.0).warnings[0]
    with pytest.raises(UsageError, match="-360 to 360"):
        with_site(Config(), None, 400.0)
    with pytest.raises(UsageError, match="-360 to 360"):
        with_site(Config(), None, math.nan)


@pytest.mark.parametrize(
    ("made", "words"),
    [
        (lambda row: replace(row, site=row.site[::-1]), "exchanged"),
        (lambda row: replace(row, site=(1000 * row.site[0], 1000 * row.site[1])), "millimetres"),
        (lambda row: replace(row, plan=(0.0, 0.0)), "one place"),
    ],
)
def test_points_that_cannot_be_meant_are_refused(made, words: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=words):
        placed_by(sample_plan(), tuple(made(row) for row in rows()))


def test_one_point_needs_a_north_angle_and_a_north_angle_alone_turns() -> None:
    with pytest.raises(InputError, match="--north"):
        placed_by(sample_plan(), rows()[:1])
    one = placed_by(sample_plan(), rows()[1:2], north_deg=-31.7)
    assert one.to_site(CORNERS[3]) == pytest.approx(TRUE.to_site(CORNERS[3]), abs=1e-6)
    turned = on_site(sample_plan(), SiteConfig(north_deg=90.0)).site
    assert turned is not None
    assert turned.to_site((-1.0, 0.0)) == pytest.approx((0.0, 1.0))  # north lies along -x of the plan
    assert on_site(sample_plan(), SiteConfig()).site is None


def test_the_template_is_read_and_bad_cells_are_named_with_their_line() -> None:
    assert [row.name for row in read_control(templates_dir() / "points.csv")] == ["A", "B", "C"]
    with pytest.raises(InputError, match="line 3: north is 'x'"):
        parse_control(b"x;y;east;north\n0;0;1,5;2\n1;1;1;x\n")
    with pytest.raises(InputError, match="name,x,y,east,north"):
        parse_control(b"a,b\n1,2\n")


@settings(max_examples=150, deadline=None)
@given(st.binary(max_size=120) | st.text(max_size=120).map(lambda text: ("x,y,east,north\n" + text).encode()))
def test_no_file_crashes_the_reader(content: bytes) -> None:
    with contextlib.suppress(InputError):
        assert all(np.isfinite([*row.plan, *row.site]).all() for row in parse_control(content))
