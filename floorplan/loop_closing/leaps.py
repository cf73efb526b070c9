"""Loops that move the trajectory far: believed when several nodes in a row say the same."""

import math
from dataclasses import dataclass, field

import numpy as np

from floorplan.geometry import wrap_to
from floorplan.loop_closing.recognise import Recognised
from floorplan.model.checks import Array

_LEAP_M = 0.8  # a narrower search cannot take one place for the next
_VOICES = 3
_MEMORY_M = 10.0  # of path within which they must speak
_AGREE_M, _AGREE_PART, _AGREE_RAD = 0.25, 0.03, math.radians(3.0)  # positions, plus a part of the way between them


@dataclass(frozen=True)
class Loop:
    """`node` sees what was seen from `place`."""

    place: int
    node: int
    known: Recognised


@dataclass
class Leaps:
    """Loops that wait for others to say the same."""

    waiting: list[Loop] = field(default_factory=list)

    def agreed(self, place: int, node: int, known: Recognised, pose: Array, path_m: Array, half_m: float) -> list[Loop]:
        """The loops to join now: this one at once where the search was narrow, else all that agree when they are enough."""
        new = Loop(place, node, known)
        if half_m <= _LEAP_M:
            return [new]
        self.waiting = [loop for loop in self.waiting if abs(path_m[loop.node] - path_m[node]) < _MEMORY_M]
        same = [loop for loop in self.waiting if _agree(loop, new, pose, path_m)]
        if len({loop.node for loop in same} | {node}) < _VOICES:
            self.waiting.append(new)
            return []
        self.waiting = [loop for loop in self.waiting if loop not in same]
        return [*same, new]


def _agree(one: Loop, other: Loop, pose: Array, path_m: Array) -> bool:
    """Whether both move the trajectory by the same: where the first would put the second's node."""
    by_one, by_other = _correction(one, pose), _correction(other, pose)
    at = pose[other.node]
    first, second = _applied(by_one, at), _applied(by_other, at)
    reach = _AGREE_M + _AGREE_PART * abs(path_m[one.node] - path_m[other.node])
    turned = abs(float(wrap_to(first[2] - second[2], 2 * np.pi)))
    return math.hypot(first[0] - second[0], first[1] - second[1]) < reach and turned < _AGREE_RAD


def _correction(loop: Loop, pose: Array) -> Array:
    """The motion (3,) of the plane that takes the loop's node to where its place says it is."""
    base, old = pose[loop.place], pose[loop.node]
    new = _applied(base, loop.known.relative)
    yaw = new[2] - old[2]
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array((new[0] - c * old[0] + s * old[1], new[1] - s * old[0] - c * old[1], yaw))


def _applied(motion: Array, pose: Array) -> Array:
    """`pose (3,)` moved by `motion (3,)`."""
    c, s = math.cos(motion[2]), math.sin(motion[2])
    return np.array((motion[0] + c * pose[0] - s * pose[1], motion[1] + s * pose[0] + c * pose[1], motion[2] + pose[2]))
