"""What the strip of the sheet says beside the title block: room schedule, notes."""

from dataclasses import dataclass

from floorplan.model.plan import FreeLine, OpeningKind, Plan
from floorplan.writers.composition import Composition
from floorplan.writers.facts import SheetFacts
from floorplan.writers.unit_style import NORMAL_95, SQUARE_METRES_PER_SQUARE_FOOT, UnitStyle, length_text

FREE_LINES_ONE_BY_ONE = 3  # more than this share one note
SCHEDULE_HEADINGS = ("No.", "Name", "Area", "±", "Height")


@dataclass(frozen=True)
class ScheduleRow:
    """One room of the schedule, worded."""

    number: str
    name: str
    area: str
    plus_minus: str
    height: str

    @property
    def cells(self) -> tuple[str, str, str, str, str]:
        return self.number, self.name, self.area, self.plus_minus, self.height


def schedule(plan: Plan, units: UnitStyle) -> tuple[ScheduleRow, ...]:
    """Rooms in the plan's order, then the total."""
    per = 1.0 if units.metric else SQUARE_METRES_PER_SQUARE_FOOT
    digits = 2 if units.metric else 1
    rows = [
        ScheduleRow(
            room.id,
            (room.name or room.kind.value) + (" (partly seen)" if room.partial else ""),
            f"{room.area_m2 / per:.{digits}f}",
            f"{NORMAL_95 * room.area_sigma_m2 / per:.{digits}f}",
            "-" if room.ceiling_height_m is None else length_text(room.ceiling_height_m, units),
        )
        for room in plan.rooms
    ]
    total = sum(room.area_m2 for room in plan.rooms)
    return (*rows, ScheduleRow("", "Total net area", f"{total / per:.{digits}f}", "", "")) if rows else ()


def area_unit(units: UnitStyle) -> str:
    return "m²" if units.metric else "sq ft"


def _free_line_notes(lines: tuple[FreeLine, ...]) -> list[str]:
    """One note per line off the axes, or one for all of them when they are many (a round hall is a chain of them)."""
    if len(lines) <= FREE_LINES_ONE_BY_ONE:
        return [
            f"Line {line.id} stands {line.off_axis_deg:.1f}° off the axes, outside the Manhattan model; "
            f"it is drawn as fitted (±{NORMAL_95 * line.sigma_m * 1000:.0f} mm)."
            for line in lines
        ]
    angles = [line.off_axis_deg for line in lines]
    worst = NORMAL_95 * max(line.sigma_m for line in lines) * 1000
    return [
        f"{len(lines)} lines ({lines[0].id} to {lines[-1].id}) stand {min(angles):.0f}° to {max(angles):.0f}° off the axes, "
        f"outside the Manhattan model; they are drawn as fitted (±{worst:.0f} mm or better)."
    ]


def notes(composition: Composition, facts: SheetFacts) -> tuple[str, ...]:
    """Numbered notes: how to read the drawing, what is outside the model, what could not be seen."""
    plan = composition.plan
    said = ["Distances are face to face, with their 95 % interval from the joint adjustment of the scan."]
    if any(wall.inferred for wall in plan.walls):
        said.append("Solid lines were seen; dashed lines are inferred.")
    if any(opening.kind == OpeningKind.DOOR for opening in plan.openings):
        said.append("Door swings are symbols: hinge and side were not surveyed.")
    said += _free_line_notes(plan.free_lines)
    if plan.glazing:
        said.append("Glazing is where rays went through between mullions; the glass itself is not measured.")
    partial = [room.id for room in plan.rooms if room.partial]
    if partial:
        said.append(f"Seen only in part: {', '.join(partial)}.")
    if all(room.ceiling_height_m is None for room in plan.rooms):
        said.append("Heights were not measured.")
    return tuple(dict.fromkeys((*said, *plan.notes, *facts.unseen)))  # the caller may repeat the plan's own notes
