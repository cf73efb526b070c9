"""How lengths are worded."""

import pytest

from floorplan.writers.unit_style import area_text, distance_text, feet_and_inches, unit_style


@pytest.mark.parametrize(
    ("length_m", "text"),
    [
        (5.432, "17'-9 7/8\""),
        (0.3048, "1'-0\""),
        (0.3048 + 0.0254 * 0.75, "1'-0 3/4\""),
        (0.0254 * 11.99, "1'-0\""),
        (3.6, "11'-9 3/4\""),
        (0.0, "0'-0\""),
    ],
)
def test_feet_and_inches_go_to_the_nearest_eighth(length_m: float, text: str) -> None:
    assert feet_and_inches(length_m) == text


def test_distances_show_their_95_percent_interval() -> None:
    assert distance_text(5.4321, 0.0061, unit_style("m")) == "5.432 m ±0.012"
    assert distance_text(5.4321, 0.0061, unit_style("mm")) == "5432 mm ±12"
    assert distance_text(5.4321, 0.0061, unit_style("ft")) == '17\'-9 7/8" ±1/2"'
    assert distance_text(5.4321, 0.0001, unit_style("ft")) == '17\'-9 7/8" ±1/8"'
    assert area_text(10.0, 0.1, unit_style("ft")) == "107.6 sq ft ±2.1"
    assert area_text(10.0, None, unit_style("m")) == "10.00 m² seen"
