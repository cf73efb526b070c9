"""What the strip of the sheet says beside the title block: room schedule, notes."""

from dataclasses import dataclass

from floorplan.model.plan import OpeningKind, Plan, Room
from floorplan.model.site import Site
from floorplan.writers.composition import Composition
from floorplan.writers.facts import SheetFacts
from floorplan.writers.unit_style import UnitStyle, area_interval, area_number, length_text

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
    rows = [
        ScheduleRow(
            room.id,
            (room.name or room.kind.value) + (" (partly seen)" if room.partial else ""),
            area_number(room.area_m2, units),
            "-" if room.partial else area_interval(room.area_sigma_m2, units),
            "-" if room.ceiling_height_m is None else length_text(room.ceiling_height_m, units),
        )
        for room in plan.rooms
    ]
    total = sum(room.area_m2 for room in plan.rooms)
    return (*rows, ScheduleRow("", "Total net area", area_number(total, units), "", "")) if rows else ()


def area_unit(units: UnitStyle) -> str:
    return "m²" if units.metric else "sq ft"


def notes(composition: Composition, facts: SheetFacts) -> tuple[str, ...]:
    """Numbered notes: how to read the drawing, what is outside the model, what could not be seen."""
    plan = composition.plan
    said = ["Distances are face to face, with their 95 % interval from the joint adjustment of the scan."]
    if facts.calibration:
        said.append(facts.calibration)
    if any(wall.inferred for wall in plan.walls):
        said.append("Solid lines were seen; dashed lines are inferred.")
    if composition.open_sides:
        said.append("Dotted: a room's open side, where no wall was seen.")
    if any(opening.kind == OpeningKind.DOOR for opening in plan.openings):
        said.append("Door swings are symbols: hinge and side were not surveyed.")
    if plan.glazing:
        said.append("Glazing is where rays went through between mullions; the glass itself is not measured.")
    if plan.site is not None:
        said.append(_site_note(plan.site, plan.rooms))
    told = " ".join((*plan.notes, *facts.unseen))
    if "heights" not in told and all(room.ceiling_height_m is None for room in plan.rooms):
        said.append("Heights were not measured.")
    if composition.left_off:
        said.append(
            f"No room at {composition.scale.label} for {', '.join(composition.left_off)}: see dimensions.csv, or use a larger sheet."
        )
    own = dict.fromkeys(plan.notes)
    said += [_counted(note, plan.notes.count(note)) for note in own] + [note for note in facts.unseen if note not in own]
    return tuple(note.replace("+-", "±") for note in dict.fromkeys(said))


def _site_note(site: Site, rooms: tuple[Room, ...]) -> str:
    """Where the drawing lies on the site grid: two corners of the rooms' extent, and how far it is turned."""
    corners = [point for room in rooms for point in room.outline] or [(0.0, 0.0)]
    low = min(x for x, _ in corners), min(y for _, y in corners)
    high = max(x for x, _ in corners), max(y for _, y in corners)
    (e1, n1), (e2, n2) = site.to_site(low), site.to_site(high)
    return (
        f"Site grid, m: the extent of all rooms has its lower left corner at E {e1:.3f}, N {n1:.3f}, "
        f"its upper right at E {e2:.3f}, N {n2:.3f}; "
        f"grid north is {site.north_deg:+.4f} degrees from the drawing's up, counter-clockwise."
    )


def _counted(note: str, times: int) -> str:
    """A note that holds several times over is said once."""
    return note if times == 1 else f"{note.removesuffix('.')} ({times} times)."
