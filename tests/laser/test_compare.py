"""Measured distances against a plan whose numbers are known."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from floorplan.cli import app
from floorplan.errors import CheckFailedError, FloorplanError, InputError, UsageError, WorkFolderError
from floorplan.laser.compare import check_plan, level_of
from floorplan.laser.spans import distance_sigma_m
from floorplan.laser.table import parse_laser
from floorplan.laser.tolerance import parse_tolerance
from floorplan.model.plan import PlanPlane
from floorplan.model.ties import Calibration, TiedDistance
from floorplan.plan.plan_json import plan_to_json
from tests.laser.plans import SHARED, SIGMA_M, two_rooms

RUNNER = CliRunner()
PLAN = two_rooms()
HEADER = "id,x1,y1,x2,y2,measured_m\n"



def test_the_sigma_of_a_distance_is_that_of_the_joint_covariance() -> None:
    assert distance_sigma_m(PLAN, 0, 1) == pytest.approx(SIGMA_M * np.sqrt(2 - 2 * SHARED))


def test_by_id_and_by_points_give_the_same_distance() -> None:
    result = check_plan(PLAN, parse_laser((HEADER + "D1,,,,,4.02\n,0.2,1.0,3.9,1.1,4.02\n,3.9,2,0.1,2,4.02").encode()))
    assert [row.plan_m for row in result.rows] == [4.0, 4.0, 4.0]
    assert [row.difference_m for row in result.rows] == pytest.approx([-0.02] * 3)
    assert len({round(row.sigma_m, 9) for row in result.rows}) == 1


def test_points_in_a_room_take_the_faces_that_look_at_each_other() -> None:
    result = check_plan(PLAN, parse_laser((HEADER + ",0.0,1,4.08,1,4.0\n,4.09,1,7.1,1,3.0\n,0,1,7.1,1,7.12").encode()))
    assert [row.plan_m for row in result.rows] == pytest.approx([4.0, 3.0, 7.12])


def test_points_on_a_walls_two_sides_measure_its_thickness() -> None:
    result = check_plan(PLAN, parse_laser((HEADER + ",3.99,1,4.13,1,0.12").encode()))
    assert [row.plan_m for row in result.rows] == pytest.approx([0.12])


def test_the_summary_is_that_of_the_rows() -> None:
    result = check_plan(PLAN, parse_laser((HEADER + "D1,,,,,4.04\nD2,,,,,2.97\nD3,,,,,5.001").encode()))
    assert result.mean_m == pytest.approx((0.04 + 0.03 + 0.001) / 3)
    assert result.worst_m == pytest.approx(0.04)
    assert result.worst_percent == pytest.approx(100 * 0.03 / 2.97)
    assert result.share_within == pytest.approx(1 / 3)
    assert [row.level for row in result.rows] == ["LOA20", "LOA20", "LOA40"]
    assert result.level == "LOA20"


@pytest.mark.parametrize(
    ("error_m", "level"),
    [(0.0009, "LOA50"), (0.002, "LOA40"), (0.015, "LOA30"), (0.016, "LOA20"), (0.05, "LOA20"), (0.15, "LOA10"), (0.151, "none")],
)
def test_the_levels_have_the_bounds_of_the_usibd(error_m: float, level: str) -> None:
    assert level_of(error_m) == level


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("D9,,,,,4.0", "no dimension D9"),
        (",0.1,1,3.1,1,3.0", "no wall square to x within 0.5 m of (3.10, 1.00)"),
        (",0.1,1,3.1,3.5,3.0", "not along an axis"),
        (",0.1,1,0.2,1,0.1", "lie on one wall"),
        ("D1,,,,,400", "centimetres?"),
        ("D1,,,,,13.123", "feet?"),
        ("D1,,,,,157.5", "inches?"),
        ("D1,,,,,1.219", "1/3.281"),
    ],
)
def test_each_row_that_cannot_be_compared_is_a_sentence(row: str, words: str) -> None:
    result = check_plan(PLAN, parse_laser((HEADER + "D2,,,,,3.0\n" + row).encode()))
    assert len(result.rows) == 1
    assert result.bad[0].text.startswith("line 3: ")
    assert words in result.bad[0].text


def test_a_surface_that_is_not_drawn_is_named_where_no_wall_is() -> None:
    panel = PlanPlane("P7", 0, -1, 3.05, 0.01, ((3.05, 3.05), (0.5, 2.0), (0.0, 2.5)), (), 10)
    covariance = np.eye(7) * 1e-4
    plan = replace(PLAN, planes=(*PLAN.planes, panel), plane_covariance_m2=covariance)
    rows = (",0.1,1,3.1,1,3.0", ",0.1,4,3.1,4,3.0")
    beside, beyond = (check_plan(plan, parse_laser((HEADER + row).encode())).bad[0].text for row in rows)
    assert beside.endswith("seen there, but not drawn as wall: P7 at x = 3.050")
    assert "P7" not in beyond


def test_millimetres_are_noticed() -> None:
    plan = two_rooms(scale=0.1)
    result = check_plan(plan, parse_laser(b"id,measured_m\nD1,400\n"))
    assert "millimetres?" in result.bad[0].text


@pytest.mark.parametrize(
    ("text", "value", "relative"),
    [("15mm", 0.015, False), ("0.015", 0.015, False), ("1 %", 1.0, True), ("2,5cm", 0.025, False)],
)
def test_a_tolerance_is_a_length_or_a_percentage(text: str, value: float, relative: bool) -> None:
    found = parse_tolerance(text)
    assert (found.value, found.relative) == (pytest.approx(value), relative)


@pytest.mark.parametrize("text", ["5", "15", "1.0"])
def test_a_bare_number_that_is_hardly_metres_needs_a_unit(text: str) -> None:
    with pytest.raises(UsageError, match=f"{text}mm"):
        parse_tolerance(text)


@pytest.fixture
def work(tmp_path: Path) -> Path:
    (tmp_path / "plan.json").write_text(plan_to_json(PLAN), "utf-8")
    (tmp_path / "laser.csv").write_text("id,measured_m\nD1,4.02\nD2,3.0\nD7,1\n", "utf-8")
    return tmp_path


def error_of(*arguments: str) -> FloorplanError:
    result = RUNNER.invoke(app, ["check", *arguments])
    assert isinstance(result.exception, FloorplanError), result.output
    return result.exception


def test_the_command_prints_the_table_and_the_verdict(work: Path) -> None:
    result = RUNNER.invoke(app, ["check", str(work), str(work / "laser.csv")])
    assert result.exit_code == 0
    assert "-20 mm" in result.stdout
    assert "2 distances, 1 row could not be compared" in result.stdout
    assert "no dimension D7" in result.stderr


def test_json_and_csv_hold_the_same_rows(work: Path) -> None:
    table = work / "out.csv"
    result = RUNNER.invoke(app, ["check", str(work), str(work / "laser.csv"), "--json", "--csv", str(table), "-q"])
    tree = json.loads(result.stdout)
    lines = table.read_text("utf-8").splitlines()
    assert "-0.0200,-0.4975" in lines[1]
    assert [row["id"] for row in tree["rows"]] == ["D1", "D2"] == [line.split(",")[1] for line in lines[1:]]
    assert tree["bad"][0]["line"] == 4


@pytest.mark.parametrize("tolerance", ["19mm", "0.4%"])
def test_past_the_tolerance_the_exit_code_is_5(work: Path, tolerance: str) -> None:
    error = error_of(str(work), str(work / "laser.csv"), "--tolerance", tolerance)
    assert isinstance(error, CheckFailedError)
    assert error.exit_code == 5
    assert "D1" in str(error)


@pytest.mark.parametrize("tolerance", ["21mm", "0.6%"])
def test_within_the_tolerance_the_exit_code_is_0(work: Path, tolerance: str) -> None:
    (work / "laser.csv").write_text("id,measured_m\nD1,4.02\nD2,3.0\nD3,\n", "utf-8")
    assert RUNNER.invoke(app, ["check", str(work), str(work / "laser.csv"), "--tolerance", tolerance]).exit_code == 0


def test_a_row_that_cannot_be_compared_proves_no_tolerance(work: Path) -> None:
    error = error_of(str(work), str(work / "laser.csv"), "--tolerance", "21mm")
    assert isinstance(error, CheckFailedError)
    assert "1 of 3 measured rows could not be compared (line 4)" in str(error)


def test_a_table_nobody_filled_says_so(work: Path) -> None:
    (work / "laser.csv").write_text("id,measured_m\nD1,\nD2,\n", "utf-8")
    assert "measured_m is empty in all of its 2 rows" in str(error_of(str(work), str(work / "laser.csv")))


def test_mistakes_have_their_kinds(work: Path, tmp_path: Path) -> None:
    laser = str(work / "laser.csv")
    assert isinstance(error_of(str(work), laser, "--tolerance", "soon"), UsageError)
    assert isinstance(error_of(str(work), str(work / "none.csv")), InputError)
    assert isinstance(error_of(str(work / "none"), laser), WorkFolderError)
    (work / "bad.csv").write_text("id,measured_m\nD7,1\n", "utf-8")
    assert isinstance(error_of(str(work), str(work / "bad.csv")), InputError)


def test_rows_that_calibrated_the_plan_are_marked_and_prove_nothing() -> None:
    tied = TiedDistance(2, "D1", 4.02, 0.002, 4.05, 4.0, 4.03, 0.01, used=True)
    table = parse_laser(b"id,measured_m\nD1,4.02\nD2,3.01\n")
    result = check_plan(PLAN, table, Calibration(1.0, 0.0, (tied,)))
    assert [row.calibrated for row in result.rows] == [True, False]
    assert result.calibrated == 1
    assert result.mean_m == pytest.approx(0.01)
    assert check_plan(PLAN, table).mean_m == pytest.approx(0.015)
    unused = Calibration(1.0, 0.0, (replace(tied, used=False),))
    assert check_plan(PLAN, table, unused).calibrated == 0


def test_corrections_by_hand_are_told_with_the_check(work: Path) -> None:
    note = "Edited by hand: always_merge tracks 3 and 17, 0.83 m apart after least squares."
    (work / "plan.json").write_text(plan_to_json(replace(PLAN, notes=("Room R1 is dark.", note))), "utf-8")
    assert f"note: {note}" in RUNNER.invoke(app, ["check", str(work), str(work / "laser.csv")]).stdout
    tree = json.loads(RUNNER.invoke(app, ["check", str(work), str(work / "laser.csv"), "--json", "-q"]).stdout)
    assert tree["edits"] == [note]
