"""What a person forbade is a constraint of the search, not a cut afterwards."""

from typing import Literal

import numpy as np
import pytest

from floorplan.config import LeastSquaresConfig, MergeConfig
from floorplan.least_squares import least_squares
from floorplan.merge import merge
from floorplan.merge.cannot_link import planes_kept_apart
from floorplan.merge.hypotheses import Pairs, no_pairs
from tests.merge.test_evidence import walk_past

WALLS = [(2.0, 0, 60), (2.0, 70, 120), (2.0, 130, 180), (2.0, 190, 240), (-3.0, 0, 240)]


@pytest.mark.parametrize("method", ["evidence", "paper"])
def test_a_forbidden_pair_is_on_two_planes_and_every_other_track_on_one_of_them(method: Literal["evidence", "paper"]) -> None:
    graph = walk_past(WALLS[:4], 240, 0.002, seed=4)
    solution, config = least_squares(graph, LeastSquaresConfig()), MergeConfig(method=method)
    assert len(np.unique(merge(graph, solution, config).plane_of_track)) == 1
    plane = merge(graph, solution, config, Pairs(np.array([0]), np.array([3]))).plane_of_track
    assert plane[0] != plane[3]
    assert set(plane[1:3].tolist()) <= {plane[0], plane[3]}


def test_without_a_forbidden_pair_nothing_changes() -> None:
    graph = walk_past(WALLS[:4], 240, 0.002, seed=4)
    solution = least_squares(graph, LeastSquaresConfig())
    free, kept = merge(graph, solution, MergeConfig()), merge(graph, solution, MergeConfig(), no_pairs())
    assert (free.track_offset_m == kept.track_offset_m).all()
    far = merge(graph, solution, MergeConfig(method="paper"), no_pairs())
    assert (far.plane_of_track == merge(graph, solution, MergeConfig(method="paper")).plane_of_track).all()


def test_pairs_are_joined_in_order_until_they_would_join_a_forbidden_one() -> None:
    accepted = Pairs(np.array([0, 2, 1, 0]), np.array([1, 3, 2, 4]))
    never = Pairs(np.array([0]), np.array([3]))
    assert planes_kept_apart(5, accepted, never).tolist() == [0, 0, 1, 1, 0]
    assert planes_kept_apart(5, accepted, no_pairs()).tolist() == [0, 0, 0, 0, 0]
