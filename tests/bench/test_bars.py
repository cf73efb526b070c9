"""The bars read the right numbers and say what misses them."""

from tests.bench.bars import BARS, table


def _score(precision: float, false_rooms: int) -> dict[str, object]:
    shares = {"3cm": precision, "5cm": precision, "10cm": precision}
    return {
        "walls": {"precision": shares, "recall": shares},
        "rooms": {"room_iou": 0.99, "corridor_iou": None, "false_rooms": false_rooms, "area_error": 0.001},
        "spans": {"mean_relative": 0.001, "p95_m": 0.01, "long_mean_relative": 0.001, "missed": 0.0},
        "doors": {"found": 1.0, "false": 0.0, "width_error_m": 0.01},
        "trajectory": {"mean_m": 0.01, "start_to_end_m": 0.01},
        "thickness": {"mean_error_m": 0.001},
    }


def test_a_bar_of_shares_asks_for_more_and_one_of_errors_for_less() -> None:
    text = table([("good", _score(0.995, 0)), ("bad", _score(0.90, 2))], hard=False)
    rows = {line.split("|")[1].strip(): line for line in text.splitlines()[2:]}
    assert len(rows) == len(BARS) - 1  # the corridors were measured nowhere
    assert "| 0.98 | 0.9475 | NO | 0.9000 bad | bad |" in rows["drawn on a true face, 5 cm"]
    assert "| 0.25 | 1.0000 | NO | 2.0000 bad | bad |" in rows["false rooms per plan"]
    assert "| 0.002 | 0.0010 | yes |" in rows["wall-to-wall, mean"]


def test_hard_scans_have_bars_of_their_own() -> None:
    text = table([("bad", _score(0.90, 0))], hard=True)
    assert "| drawn on a true face, 3 cm | - | 0.9000 | yes |" in text
    assert "| drawn on a true face, 5 cm | 0.8 | 0.9000 | yes |" in text
