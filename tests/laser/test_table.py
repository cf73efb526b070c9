"""LASER.csv is read as people write it; nothing in it crashes the reader."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from floorplan.errors import InputError
from floorplan.laser.compare import check_plan
from floorplan.laser.table import LaserTable, parse_laser, read_laser
from floorplan.model.plan import Plan
from floorplan.templates_dir import templates_dir
from tests.laser.plans import two_rooms

PLAN: Plan = two_rooms()
ODD = st.sampled_from(
    ["", "D1", "d2", "5.4", "5,4", "nan", "inf", "-3", "0", "1e400", "٣", "5.4 m", "5400mm", '"', "'", ";", ",", "\t", "\x00", "é", "1.2.3"]
)

CELLS = st.lists(st.lists(st.one_of(ODD, st.text(max_size=12)), max_size=9), max_size=8)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "latin-1", "utf-16"])
@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
def test_the_same_table_in_every_encoding_with_every_line_ending(encoding: str, ending: str) -> None:
    text = "id;measured_m;note\nD1;5,432;Küche\nD2;1 234,5 mm;\n".replace("\n", ending)
    table = parse_laser(text.encode(encoding))
    assert [(row.id, row.measured_m, row.note) for row in table.rows] == [("D1", 5.432, "Küche"), ("D2", 1.2345, "")]
    assert not table.bad


@pytest.mark.parametrize(
    ("text", "metres"),
    [("5.432", 5.432), ("5,432", 5.432), ("5.432 m", 5.432), ("5432 mm", 5.432), ("543.2cm", 5.432), ("10 ft", 3.048), (".5", 0.5)],
)
def test_lengths_are_read_as_they_are_written(text: str, metres: float) -> None:
    (row,) = parse_laser(f'id,measured_m\nD1,"{text}"\n'.encode()).rows
    assert row.measured_m == pytest.approx(metres, abs=1e-12)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("D1,5,432", "decimal commas need semicolons"),
        ("D1,five", "no length"),
        ("D1,-2", "no laser meter says"),
        (",3.2", "neither the id"),
        ("D1,99999", "no laser meter says"),
        ("D1,nan", "no length"),
    ],
)
def test_each_bad_row_is_a_sentence_with_its_line(row: str, words: str) -> None:
    table = parse_laser(f"id,measured_m\nD9,1.0\n{row}\n".encode())
    assert [good.id for good in table.rows] == ["D9"]
    assert table.bad[0].line == 3
    assert table.bad[0].text.startswith("line 3: ")
    assert words in table.bad[0].text


def test_a_distance_given_twice_counts_once() -> None:
    table = parse_laser(b"id,measured_m\nD1,1.0\nd1,1.1\n")
    assert len(table.rows) == 1
    assert "line 2 already" in table.bad[0].text


def test_rows_without_a_value_are_waiting_not_wrong() -> None:
    table = parse_laser(b"id,plan_m,measured_m\nD1,4.0,\nD2,3.0,3.1\n\n")
    assert (len(table.rows), len(table.bad), table.empty) == (1, 0, 1)


@pytest.mark.parametrize("content", [b"", b"\n\n", b"a,b\n1,2\n", b"\xff\xfe", b"\x89PNG\r\n\x1a\n", b"id;measured\nD1;3"])
def test_what_is_no_table_is_refused_with_the_way_out(content: bytes) -> None:
    with pytest.raises(InputError, match="header row"):
        parse_laser(content)


@settings(deadline=None, derandomize=True)
@given(st.binary(max_size=400))
def test_any_bytes_are_read_or_refused(content: bytes) -> None:
    _read_or_refuse(content)


@settings(deadline=None, derandomize=True)
@given(CELLS, st.sampled_from([",", ";", "\t"]), st.sampled_from(["utf-8", "utf-8-sig", "utf-16"]))
def test_any_rows_under_a_good_header_are_rows_or_sentences(rows: list[list[str]], separator: str, encoding: str) -> None:
    lines = [["id", "x1", "y1", "x2", "y2", "measured_m", "sigma_m", "note"], *rows]
    content = "\n".join(separator.join(line) for line in lines).encode(encoding, "replace")
    table = _read_or_refuse(content)
    assert table is not None
    assert all(0 < row.measured_m <= 1000 for row in table.rows)
    assert all(row.id or (row.start and row.end) for row in table.rows)


def _read_or_refuse(content: bytes) -> LaserTable | None:
    try:
        table = parse_laser(content)
    except InputError:
        return None
    result = check_plan(PLAN, table)
    assert len(result.rows) + len(result.bad) == len(table.rows) + len(table.bad)
    return table


def test_the_template_is_a_table() -> None:
    table = read_laser(templates_dir() / "laser.csv")
    assert (table.rows, table.bad, table.empty) == ((), (), 2)  # examples that cannot be mistaken for measurements
