"""What a reader of the drawing must be told of a plan, each thing once."""

from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Face, FreeLine, Room, Wall

ONE_BY_ONE = 3  # more lines off the axes than these share one note


def plan_notes(rooms: tuple[Room, ...], lines: tuple[FreeLine, ...], heights: bool, floor_seen: bool) -> tuple[str, ...]:
    """Sentences; things go by their ids."""
    notes = [_off_axes(lines)] if lines else []
    partial = [room.id for room in rooms if room.partial]
    if partial:
        notes.append(f"Not closed by seen walls; areas are of what was seen: {', '.join(partial)}.")
    if not heights:
        notes.append("Recorded by a level laser: no heights; openings are gaps at the laser's level.")
    elif not floor_seen:
        notes.append("No floor was seen: heights are not above the floor, and what reaches wall height is uncertain.")
    return tuple(notes)


def _off_axes(lines: tuple[FreeLine, ...]) -> str:
    """One note for all of them: a round hall is a chain of many."""
    worst_mm = NORMAL_95 * max(line.sigma_m for line in lines) * 1000
    fitted = f"they are drawn as fitted, +-{worst_mm:.0f} mm or better"
    if len(lines) <= ONE_BY_ONE:
        angles = ", ".join(f"{line.id} {line.off_axis_deg:.1f} deg" for line in lines)
    else:
        least, most = min(line.off_axis_deg for line in lines), max(line.off_axis_deg for line in lines)
        angles = f"{len(lines)} lines ({lines[0].id} to {lines[-1].id}) by {least:.0f} to {most:.0f} deg"
    return f"Off the axes, outside the Manhattan model: {angles}; {fitted}."


def through_glass_notes(walls: tuple[Wall, ...], faces: tuple[Face, ...], planes: frozenset[str]) -> tuple[str, ...]:
    """Which walls lie on planes (ids) that were seen through glass alone; nothing where none does."""
    behind = {face.id for face in faces if face.plane in planes}
    ids = [wall.id for wall in walls if wall.faces and set(wall.faces) <= behind]
    return (f"Seen through glass only, drawn as inferred: {', '.join(ids)}.",) if ids else ()
