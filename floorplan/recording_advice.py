"""How a walk could have been better, from the recording alone: speed, turns, gaps, the way back, empty pixels."""

import math

import numpy as np

from floorplan.model.advice import Advice
from floorplan.model.scan import Recording, SensorKind
from floorplan.recording_checks import Motion, frame_gaps, motion_of

FAST_M_S = 1.5  # brisk walking; images blur, rooms are passed in a few frames
SPEED_SHARE = 0.95  # of the time slower than the speed that is told
SHARED_VIEW = 0.5  # of the field of view that two frames in a row should share, or tracks of walls break
LASER_FIELD_RAD = math.pi
CLOSED_M, CLOSED_SHARE = 1.0, 0.05  # a walk ends where it began within this, plus this share of its length for drift
POOR_FILL = 0.5  # of a depth image's pixels
SHORT_M = 3.0  # hardly walked: one room from one place needs no way back


def recording_advice(recording: Recording, filled_share: float | None = None) -> tuple[Advice, ...]:
    """Everything the recording shows, in the order of its weight. `filled_share` of pixels with a reading, where known."""
    motion = motion_of(recording)
    if not len(motion.seconds):
        return ()
    found = (_gap_advice(motion), _turn_advice(recording, motion), _speed_advice(motion), _loop_advice(recording, motion))
    return tuple(one for one in (*found, _fill_advice(filled_share)) if one is not None)


def walking_speed_m_s(motion: Motion) -> float:
    """The speed that `SPEED_SHARE` of the walking time stays under, over steps of about half a second; 0 where nothing moved."""
    if not len(motion.seconds):
        return 0.0
    time, way = np.cumsum(motion.seconds), np.cumsum(motion.moved_m)
    marks = np.searchsorted(time, np.arange(0.0, float(time[-1]), 0.5))
    seconds, metres = np.diff(time[marks]), np.diff(way[marks])
    walked = (seconds > 0) & (metres > 0.05 * seconds)
    return float(np.quantile(metres[walked] / seconds[walked], SPEED_SHARE)) if walked.any() else 0.0


def field_of_view_rad(recording: Recording) -> float:
    """The horizontal field of view."""
    lens = recording.sensor.intrinsics
    if recording.sensor.kind is SensorKind.LIDAR:
        return 2 * math.pi
    return LASER_FIELD_RAD if lens is None else 2 * math.atan(lens.width / (2 * lens.fx))


def _gap_advice(motion: Motion) -> Advice | None:
    gaps = frame_gaps(motion)
    if not gaps.any():
        return None
    longest_s, walked_m = float(motion.seconds[gaps].max()), float(motion.moved_m[gaps].sum())
    lost = f"{int(gaps.sum())} gap{'s' if gaps.sum() > 1 else ''} of up to {longest_s:.1f} s, {walked_m:.1f} m walked unseen"
    return Advice("gaps", lost, "close other programs while recording; walk those places again")


def _turn_advice(recording: Recording, motion: Motion) -> Advice | None:
    field = field_of_view_rad(recording)
    lost = (motion.turned_rad > (1 - SHARED_VIEW) * field) & ~frame_gaps(motion)
    if not lost.any():
        return None
    fastest = math.degrees(float((motion.turned_rad[lost] / motion.seconds[lost]).max()))
    turns = "1 turn" if lost.sum() == 1 else f"{int(lost.sum())} turns"
    fact = f"{turns} of up to {fastest:.0f} degrees a second with less than half of the view in common"
    return Advice("turns", fact, "turn more slowly")


def _speed_advice(motion: Motion) -> Advice | None:
    speed = walking_speed_m_s(motion)
    return Advice("speed", f"walked at up to {speed:.1f} m/s", "walk slower, about 0.8 m/s") if speed > FAST_M_S else None


def _loop_advice(recording: Recording, motion: Motion) -> Advice | None:
    path = float(motion.moved_m.sum())
    apart = float(np.linalg.norm(recording.position_m[-1] - recording.position_m[0]))
    if path < SHORT_M or apart < CLOSED_M + CLOSED_SHARE * path:
        return None
    fact = f"the walk of {path:.0f} m ends {apart:.1f} m from where it began"
    return Advice("loop", fact, "walk back to the start and look at the first walls again: what is seen twice takes the drift out")


def _fill_advice(filled_share: float | None) -> Advice | None:
    if filled_share is None or filled_share >= POOR_FILL:
        return None
    fact = f"only {100 * filled_share:.0f} % of the pixels have a reading"
    return Advice("empty-pixels", fact, "stay within the sensor's range of the walls")
