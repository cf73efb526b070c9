"""Readings counted beside the lines of a grid, against a count by hand."""

import numpy as np

from floorplan.plan.line_kernels import counted_within


def test_each_bin_counts_the_readings_of_its_column_within_its_reach() -> None:
    rng = np.random.default_rng(5)
    lines, columns, half = 30, 4, np.array([0, 2, 12, 40])
    across, along = rng.integers(0, lines, 200), rng.integers(0, columns, 200)
    counted = counted_within(across, along, lines, columns, half)
    for k, reach in enumerate(half):
        for a in range(lines):
            near = np.abs(across - a) <= reach
            assert counted[k, a].tolist() == np.bincount(along[near], minlength=columns).tolist()
