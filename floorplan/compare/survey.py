"""What is compared of one survey: its plan, and where its sensor looked."""

from dataclasses import dataclass

import numpy as np

from floorplan.geometry import rotation_about_z
from floorplan.model.checks import Array, freeze
from floorplan.model.plan import Plan
from floorplan.placed_points import sensor_rays
from floorplan.results import Results

MOST_RAYS = 400_000  # evenly chosen: a stretch of wall is crossed by hundreds of them where it was looked through


@dataclass(frozen=True)
class Rays:
    """Rays that ended on a surface: `start_m (R, 3)` at the sensor, `end_m (R, 3)`, plan frame."""

    start_m: Array
    end_m: Array

    def __post_init__(self) -> None:
        freeze(self, {"start_m": (np.float64, ("R", 3)), "end_m": (np.float64, ("R", 3))})

    def turned(self, quarters: int, shift_m: Array) -> "Rays":
        """Quarter turns counter-clockwise, then the shift (3,)."""
        turn = np.rint(rotation_about_z(np.array(quarters * np.pi / 2)))
        return Rays(self.start_m @ turn.T + shift_m, self.end_m @ turn.T + shift_m)


@dataclass(frozen=True)
class Survey:
    """One survey under the name it is told by."""

    name: str
    plan: Plan
    rays: Rays


def survey_of(name: str, results: Results) -> Survey:
    """A finished build as a survey."""
    return Survey(name, results.plan, Rays(*sensor_rays(results, MOST_RAYS)))
