"""What would make a finished survey better: where it is blind, where it is uncertain, and what would help."""

import numpy as np

from floorplan.model.advice import Advice
from floorplan.model.error_parts import ErrorCause
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Certainty, Dimension, Plan, PlanPlane
from floorplan.model.range_bias import RangeBias
from floorplan.model.scan import NANOSECONDS_PER_SECOND
from floorplan.model.segment import AXIS_Z
from floorplan.recording_advice import recording_advice
from floorplan.results import Results

FEW_FRAMES = 5  # keyframes; a wall seen in fewer was passed by, not surveyed
BLIND_SHARE = 0.10  # of the keyframes without a wall in view
WIDE_M, WIDE_SHARE = 0.015, 0.01  # half an interval: past LOA30 and past a per cent, a dimension is worth a laser meter
INFERRED_SHARE = 0.15  # of the wall length that was bridged, not seen
WHY = {  # what most of an interval is, and what makes that part smaller
    ErrorCause.PATH: ("the walk between its two ends", "walk a loop through there, or measure it by hand and give it with --laser"),
    ErrorCause.SURFACES: ("sightings of its two surfaces that disagree", "look at both again from nearby and square on"),
    ErrorCause.MERGES: ("surfaces taken for one that may be two", "measure it by hand and give it with --laser, or see 'floorplan merges'"),
    ErrorCause.SCALE: ("the scale of the sensor's ranges, which no scan shows", "measure it by hand and give it with --laser"),
    ErrorCause.SENSOR: ("the constant bias that such a sensor may have", "state range_bias_sigma where the sensor was calibrated"),
    ErrorCause.TAPE: ("the distances measured by hand", "measure again with a better meter"),
}
SIDES = (("left", "right"), ("lower", "upper"))  # of the drawing, by the end of x and y


def survey_advice(results: Results) -> tuple[Advice, ...]:
    """The walk's faults, then the plan's, by what they cost."""
    plan = results.plan
    walk = () if results.scan.parts else recording_advice(results.scan.recording)  # of scans joined, each folder has its own
    found = [*walk, _blind(results), _weak_walls(plan), _inferred(plan), _wide(plan)]
    found += [_unvisited(plan), *range_advice(results.layout.range_bias)]
    return tuple(one for one in found if one is not None)


def range_advice(bias: RangeBias | None) -> tuple[Advice, ...]:
    """Errors of the depth that are larger than the scan's doubt about them, with the settings that take them out."""
    found = []
    if bias is not None and bias.scale_is_significant:
        interval = 100 * NORMAL_95 * bias.scale_sigma
        fact = f"ranges are {100 * bias.scale:+.1f} % +-{interval:.1f} long against the steps of the odometry, and either may be at fault"
        way = f"measure one long distance by hand and give it with --laser; if it is the depth, --set read.range_scale={1 + bias.scale:.4f}"
        found.append(Advice("range-scale", fact, way))
    if bias is not None and bias.offset_is_significant:
        interval = 1000 * NORMAL_95 * bias.offset_sigma_m
        fact = f"every range is {1000 * bias.offset_m:+.0f} mm +-{interval:.0f} off, near and far surfaces say"
        found.append(Advice("range-offset", fact, f"--set read.range_offset_mm={1000 * bias.offset_m:.0f} takes it out"))
    return tuple(found)


def _blind(results: Results) -> Advice | None:
    measured = results.segmented.frames.measured
    blind = ~measured
    if blind.mean() <= BLIND_SHARE:
        return None
    start, length = _longest_run(blind)
    stamps = results.scan.recording.stamp_ns[results.scan.keyframe]
    when = float(stamps[start] - results.scan.recording.stamp_ns[0]) / NANOSECONDS_PER_SECOND
    fact = f"{100 * blind.mean():.0f} % of the frames show no wall, the longest stretch ({length} keyframes) from {when:.0f} s on"
    return Advice("blind-frames", fact, "keep a wall or the floor in view, two to four metres away")


def _longest_run(flags: np.ndarray) -> tuple[int, int]:
    """Start and length of the longest run of True."""
    edges = np.diff(np.concatenate(([0], flags.astype(int), [0])))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    longest = int(np.argmax(ends - starts))
    return int(starts[longest]), int(ends[longest] - starts[longest])


def _weak_walls(plan: Plan) -> Advice | None:
    drawn = {face.plane for face in plan.faces if face.certainty is Certainty.SEEN}
    weak = [plane for plane in plan.planes if plane.id in drawn and plane.axis != AXIS_Z and plane.frames < FEW_FRAMES]
    if not weak:
        return None
    names = ", ".join(plane.id for plane in weak[:6]) + (" ..." if len(weak) > 6 else "")
    fact = f"{len(weak)} of {len(drawn)} wall planes were seen in fewer than {FEW_FRAMES} keyframes ({names})"
    return Advice("seen-once", fact, f"scan the {_side(plan, weak)} of the drawing again, slowly")


def _side(plan: Plan, weak: list[PlanPlane]) -> str:
    """The side of the plan where most of the weak planes lie: 'upper left', 'right', 'middle'."""
    ends = np.array([point for face in plan.faces for point in (face.start, face.end)])
    low, high = ends.min(axis=0), ends.max(axis=0)
    middle = np.array([[sum(plane.extent_m[axis]) / 2 for axis in range(2)] for plane in weak])
    share = (np.median(middle, axis=0) - low) / np.maximum(high - low, 1e-6)
    words = [SIDES[axis][int(share[axis] > 0.5)] for axis in (1, 0) if abs(share[axis] - 0.5) > 1 / 6]
    return f"{' '.join(words)} side" if words else "middle"


def _inferred(plan: Plan) -> Advice | None:
    lengths = {certainty: 0.0 for certainty in Certainty}
    for face in plan.faces:
        lengths[face.certainty] += float(np.hypot(face.end[0] - face.start[0], face.end[1] - face.start[1]))
    share = lengths[Certainty.INFERRED] / max(sum(lengths.values()), 1e-9)
    if share <= INFERRED_SHARE:
        return None
    fact = f"{100 * share:.0f} % of the wall length was not seen but bridged"
    return Advice("inferred", fact, "look behind furniture and into corners; the dashed lines show where")


def _wide(plan: Plan) -> Advice | None:
    """The least certain distance, where it is worth measuring."""
    if not plan.dimensions:
        return None
    widest: Dimension = max(plan.dimensions, key=lambda dimension: dimension.sigma_m)
    interval = NORMAL_95 * widest.sigma_m
    if interval <= max(WIDE_M, WIDE_SHARE * widest.distance_m):
        return None
    where = f" in {widest.room}" if widest.room else ""
    fact = f"{widest.id}{where} is the least certain: {widest.distance_m:.3f} m +-{interval:.3f}"
    if widest.sigma_parts is None:
        return Advice("least-certain", fact, "measure it by hand and give it with --laser, or walk a loop through there")
    cause, way = WHY[widest.sigma_parts.by_size[0][0]]
    return Advice("least-certain", f"{fact}, most of it {cause}", way)


def _unvisited(plan: Plan) -> Advice | None:
    rooms = [room.id for storey in plan.storeys for room in storey.rooms if not room.visited or room.partial]
    if not rooms:
        return None
    return Advice("unvisited", f"{', '.join(rooms)}: seen from outside only, or not closed by seen walls", "walk in and look at every wall")
