"""Laying one scan on another: the truth is a floor of known rooms and a known turn and shift."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from floorplan.errors import InputError
from floorplan.several.lay import lay_all
from floorplan.several.start import near_common_start, near_points, read_point_pairs
from floorplan.several.survey import Laying, Survey, laid
from tests.several.floors import ROOMS, floor_survey

NAMES = ["first", "second", "third"]


def moved(survey: Survey, quarters: int, shift: tuple[float, float]) -> tuple[Survey, Laying]:
    """The survey as another plan frame has it, and the laying that brings it back."""
    there = Laying(quarters, np.array(shift))
    back = Laying(-quarters % 4, np.zeros(2))
    return laid(survey, there), replace(back, shift_m=-back.xy(there.shift_m))


def anywhere(number: int, survey: Survey) -> None:
    del number, survey


@pytest.mark.parametrize("quarters", [0, 1, 2, 3])
def test_a_scan_of_three_rooms_is_found_on_a_scan_of_three_others_by_the_two_they_share(quarters: int) -> None:
    other, back = moved(floor_survey(ROOMS[2:6]), quarters, (3.21, -7.77))
    found = lay_all([floor_survey(ROOMS[:4]), other], NAMES, anywhere)[1]
    assert found.laying.quarters == back.quarters
    assert np.abs(found.laying.shift_m - back.shift_m).max() < 1e-6
    assert found.sigma_m == 0.05


def test_walls_that_are_off_by_centimetres_still_agree_and_the_shift_is_their_mean() -> None:
    rng = np.random.default_rng(5)
    other, back = moved(floor_survey(ROOMS[1:5]), 1, (10.0, 2.0))
    other = replace(other, offset_m=other.offset_m + rng.normal(0, 0.02, len(other.offset_m)))
    found = lay_all([floor_survey(ROOMS[:4]), other], NAMES, anywhere)[1]
    assert 1e-4 < np.abs(found.laying.shift_m - back.shift_m).max() < 0.03


def test_a_third_scan_hangs_on_the_second_when_it_shares_nothing_with_the_first() -> None:
    second, back_second = moved(floor_survey(ROOMS[1:5]), 2, (1.0, 1.0))
    third, back_third = moved(floor_survey(ROOMS[3:]), 3, (-4.0, 6.0))
    found = lay_all([floor_survey(ROOMS[:3]), third, second], NAMES, anywhere)
    for laid_scan, back in zip(found[1:], (back_third, back_second), strict=True):
        assert laid_scan.laying.quarters == back.quarters
        assert np.abs(laid_scan.laying.shift_m - back.shift_m).max() < 1e-6


def test_a_scan_of_another_building_is_refused_with_the_numbers() -> None:
    rng = np.random.default_rng(3)
    x, y = np.cumsum(rng.uniform(2.7, 6.0, 4)), np.cumsum(rng.uniform(2.9, 5.0, 3))
    other = floor_survey(tuple((x[i], y[j], x[i + 1] - 0.15, y[j + 1] - 0.15) for i in range(3) for j in range(2)))
    with pytest.raises(InputError, match=r"second: .*(m of wall|two places).*--start"):
        lay_all([floor_survey(ROOMS), other], NAMES, anywhere)


def test_one_of_two_equal_rooms_is_refused_for_it_may_be_either() -> None:
    twins = ((0.0, 0.0, 4.0, 3.0), (5.0, 0.0, 9.0, 3.0))
    other, _ = moved(floor_survey(twins[1:]), 0, (1.0, 1.0))
    with pytest.raises(InputError, match="too little in common"):  # one bare room is like another
        lay_all([floor_survey(twins), other], NAMES, anywhere)
    base = replace(floor_survey(twins), first_xy_m=np.array([6.5, 1.2]))
    with pytest.raises(InputError, match=r"two places.*turned by 180 degrees"):  # and looks the same from both sides
        lay_all([base, other], NAMES, lambda number, survey: near_common_start(base, survey))


def pairs_file(path: Path, back: Laying, wrong_m: float = 0.0) -> Path:
    other = np.array([[1.0, 1.0], [4.0, 2.0], [2.0, 5.0], [6.0, 3.0]])
    first = back.xy(other)
    first[2] += wrong_m
    rows = [",".join(f"{value:.2f}" for value in (*a, *b)) for a, b in zip(first, other, strict=True)]
    path.write_text("\n".join(["# read off both plans", "x1,y1,x2,y2", *rows]) + "\n")
    return path


def test_point_pairs_choose_between_places_and_the_walls_make_them_exact(tmp_path: Path) -> None:
    twins = ((0.0, 0.0, 4.0, 3.0), (5.0, 0.0, 9.0, 3.0))
    other, back = moved(floor_survey(twins[1:]), 3, (1.0, 1.0))
    path = pairs_file(tmp_path / "pairs.csv", replace(back, shift_m=back.shift_m + 0.2))
    pairs = read_point_pairs(path)
    found = lay_all([floor_survey(twins), other], NAMES, lambda number, survey: near_points(pairs, number, path))[1]
    assert found.laying.quarters == back.quarters
    assert np.abs(found.laying.shift_m - back.shift_m).max() < 1e-6


def test_a_pair_that_does_not_fit_the_others_is_named_by_its_line(tmp_path: Path) -> None:
    path = pairs_file(tmp_path / "pairs.csv", Laying(1, np.array([2.0, 0.0])), wrong_m=1.5)
    with pytest.raises(InputError, match=r"line 5 misses the other pairs of scan 2 by 1\.\d+ m"):
        near_points(read_point_pairs(path), 2, path)


def test_pairs_that_put_a_scan_where_its_walls_contradict_are_refused(tmp_path: Path) -> None:
    other, back = moved(floor_survey(ROOMS[2:6]), 1, (3.0, 1.0))
    path = pairs_file(tmp_path / "pairs.csv", replace(back, shift_m=back.shift_m + np.array([2.6, -1.9])))
    pairs = read_point_pairs(path)
    with pytest.raises(InputError, match=r"second: (its walls contradict|too little|no place)"):
        lay_all([floor_survey(ROOMS[:4]), other], NAMES, lambda number, survey: near_points(pairs, number, path))


UNREADABLE = [
    ("a,b\n1,2\n", "header must name"),
    ("x1,y1,x2,y2\n1,2,3,\n", "no four numbers"),
    ("x1,y1,x2,y2\n1,2,3,nan\n", "no length"),
]


@pytest.mark.parametrize(("text", "told"), UNREADABLE)
def test_a_file_of_pairs_that_cannot_be_read_says_why(tmp_path: Path, text: str, told: str) -> None:
    (tmp_path / "pairs.csv").write_text(text)
    with pytest.raises(InputError, match=told):
        read_point_pairs(tmp_path / "pairs.csv")


def test_pairs_are_read_as_spreadsheets_write_them(tmp_path: Path) -> None:
    (tmp_path / "pairs.csv").write_bytes("\ufeff# T\u00fcr\r\nx1;y1;x2;y2;scan\r\n1,5;2;3;4;\r\n1;2;3;4;3\r\n".encode())
    (tmp_path / "latin.csv").write_bytes("x1,y1,x2,y2,note\n1.5,2,3,4,T\u00fcr\n".encode("latin-1"))
    pairs, latin = read_point_pairs(tmp_path / "pairs.csv"), read_point_pairs(tmp_path / "latin.csv")
    assert pairs.scan.tolist() == [2, 3]
    assert pairs.line.tolist() == [3, 4]
    assert pairs.first_xy_m[0].tolist() == latin.first_xy_m[0].tolist() == [1.5, 2.0]
