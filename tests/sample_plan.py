"""A rich plan made by hand: a ring corridor about a core, six rooms, doors, a passage, glazing, a column, a skewed wall."""

import numpy as np

from floorplan.model.plan import (
    Certainty,
    Column,
    Dimension,
    DimensionRole,
    Face,
    FreeLine,
    Glazing,
    Opening,
    OpeningKind,
    Plan,
    PlanPlane,
    Point,
    Rejection,
    Room,
    RoomKind,
    Wall,
)
from floorplan.model.scan import Trajectory

X0, X1, X2, X3, X4, X5 = 0.0, 4.0, 4.12, 8.5, 8.62, 13.4
Y0, Y1, Y2, Y3, Y4, Y5 = 0.0, 3.6, 3.72, 7.9, 8.02, 12.0
SKIN = 0.30


def _box(x0: float, y0: float, x1: float, y1: float) -> tuple[Point, ...]:
    return (x0, y0), (x1, y0), (x1, y1), (x0, y1)


def _closed(points: tuple[Point, ...]) -> tuple[Point, ...]:
    return (*points, points[0])


def _wall(number: int, outline: tuple[Point, ...], thickness: float) -> Wall:
    return Wall(f"W{number}", (), (_closed(outline),), (), _closed(outline), thickness, 0.003, 2.64)


def _walls() -> tuple[Wall, ...]:
    walls = [
        _wall(1, _box(-SKIN, -SKIN, X5 + SKIN, Y0), SKIN),
        _wall(2, _box(-SKIN, Y0, X0, Y5), SKIN),
        _wall(3, _box(X1, Y0, X2, Y1 - 1.5), 0.12),
        _wall(4, _box(X1, Y1 - 0.6, X2, Y1), 0.12),
        _wall(5, _box(X3, Y0, X4, Y1), 0.12),
        _wall(6, _box(X0, Y1, 1.5, Y2), 0.12),
        _wall(7, _box(2.4, Y1, 5.6, Y2), 0.12),
        _wall(8, _box(6.5, Y1, 10.0, Y2), 0.12),
        _wall(9, _box(11.0, Y1, X5, Y2), 0.12),
        _wall(10, _box(2.0, 5.4, 10.8, 6.3), 0.9),
        _wall(11, _box(X0, Y3, 2.0, Y4), 0.12),
        _wall(12, _box(2.9, Y3, 7.0, Y4), 0.12),
        _wall(13, _box(8.4, Y3, X5, Y4), 0.12),
        _wall(14, _box(6.0, Y4, 6.12, Y5), 0.12),
        # seen from one side alone: a line, its far side not invented
        Wall("W15", (), (((X5, Y0), (X5, 5.0)), ((X5, 5.6), (X5, Y3)))),
        # a wall with an unseen end: one face longer than the other
        Wall(
            "W16",
            (),
            (((X0, Y5), (5.2, Y5)), ((X0, Y5 + SKIN), (4.0, Y5 + SKIN)), ((X0, Y5), (X0, Y5 + SKIN))),
            (((5.2, Y5), (6.0, Y5)), ((4.0, Y5 + SKIN), (6.0, Y5 + SKIN)), ((6.0, Y5), (6.0, Y5 + SKIN))),
            _closed(_box(X0, Y5, 6.0, Y5 + SKIN)),
            SKIN,
            0.006,
        ),
        Wall("W17", (), (((X5, Y4), (X5, 10.1)),), (((X5, 10.1), (X5, 10.6)),)),
    ]
    return tuple(walls)


def _rooms() -> tuple[Room, ...]:
    def room(number: int, name: str, outline: tuple[Point, ...], label: Point, area: float, **more: object) -> Room:
        return Room(f"R{number}", RoomKind.ROOM, name, outline, area, 0.004 * area, label=label, **more)  # type: ignore[arg-type]

    ring = _box(X0, Y2, X5, Y3)
    core = ((2.0, 5.4), (2.0, 6.3), (10.8, 6.3), (10.8, 5.4))
    return (
        room(1, "Office", _box(X0, Y0, X1, Y1), (2.0, 1.8), 4.0 * 3.6, ceiling_height_m=2.642, ceiling_sigma_m=0.004),
        room(2, "Meeting room", _box(X2, Y0, X3, Y1), (6.3, 1.8), 4.38 * 3.6, ceiling_height_m=2.640, ceiling_sigma_m=0.003),
        room(3, "Office", _box(X4, Y0, X5, Y1), (11.0, 1.8), 4.78 * 3.6, ceiling_height_m=2.638, ceiling_sigma_m=0.006),
        Room("R4", RoomKind.CORRIDOR, "Corridor", ring, 13.4 * 4.18 - 8.8 * 0.9, 0.2, (core,), (1.0, 4.6), 2.40, 0.005),
        room(5, "Store", _box(X0, Y4, 6.0, Y5), (3.0, 10.0), 6.0 * 3.98, ceiling_height_m=2.64),
        room(6, "", ((6.12, Y4), (X5, Y4), (X5, 10.6), (6.12, Y5)), (9.0, 9.4), 23.7, partial=True, visited=False),
    )


def _openings() -> tuple[Opening, ...]:
    def door(number: int, x: float, width: float, y: float = (Y1 + Y2) / 2, kind: OpeningKind = OpeningKind.DOOR) -> Opening:
        return Opening(f"O{number}", kind, (x, y), 0, width, 0.008, ("W6", "W7"), 0.12, 2.05, None, True)

    return (
        door(1, 1.95, 0.9),
        door(2, 6.05, 0.9),
        door(3, 10.5, 1.0),
        door(4, 2.45, 0.9, (Y3 + Y4) / 2),
        door(5, 7.7, 1.4, (Y3 + Y4) / 2, OpeningKind.PASSAGE),
        Opening("O6", OpeningKind.DOOR, ((X1 + X2) / 2, Y1 - 1.05), 1, 0.9, 0.009, ("W3", "W4"), 0.12, 2.04),
        Opening("O7", OpeningKind.WINDOW, (X5, 5.3), 1, 0.6, 0.02, ("W15",), 0.0, 2.1, 0.9),
    )


def _dimensions() -> tuple[Dimension, ...]:
    spans = (
        (DimensionRole.ROOM, 0, X0, X1, 1.2, "R1"),
        (DimensionRole.ROOM, 1, Y0, Y1, 0.8, "R1"),
        (DimensionRole.ROOM, 0, X2, X3, 1.8, "R2"),
        (DimensionRole.ROOM, 1, Y0, Y1, 6.3, "R2"),
        (DimensionRole.ROOM, 0, X4, X5, 1.0, "R3"),
        (DimensionRole.ROOM, 1, Y0, Y1, 12.6, "R3"),
        (DimensionRole.ROOM, 1, Y2, 5.4, 5.0, "R4"),
        (DimensionRole.ROOM, 0, 10.8, X5, 5.8, "R4"),
        (DimensionRole.ROOM, 0, X0, 6.0, 9.0, "R5"),
        (DimensionRole.ROOM, 1, Y4, Y5, 1.0, "R5"),
        (DimensionRole.CHAIN, 0, X0, X1, -1.3, ""),
        (DimensionRole.CHAIN, 0, X2, X3, -1.3, ""),
        (DimensionRole.CHAIN, 0, X4, X5, -1.3, ""),
        (DimensionRole.CHAIN, 0, X1, X2, -1.3, ""),
        (DimensionRole.OVERALL, 0, X0, X5, -2.1, ""),
        (DimensionRole.CHAIN, 1, Y0, Y1, -1.3, ""),
        (DimensionRole.CHAIN, 1, Y2, Y3, -1.3, ""),
        (DimensionRole.OVERALL, 1, Y0, Y5, -2.1, ""),
    )
    drawn = []
    for number, (role, axis, low, high, across, room) in enumerate(spans, 1):
        start, end, line = (low, across), (high, across), ((low + high) / 2, across)
        if axis == 1:
            start, end, line = (across, low), (across, high), (across, (low + high) / 2)
        drawn.append(Dimension(f"D{number}", role, "P1", "P2", axis, high - low, 0.006, start, end, line, room))
    height = Dimension(f"D{len(spans) + 1}", DimensionRole.HEIGHT, "P5", "P6", 2, 2.642, 0.004, (2.0, 1.8), (2.0, 1.8), (2.0, 1.8), "R1")
    return (*drawn, height)


def _planes() -> tuple[PlanPlane, ...]:
    def plane(number: int, axis: int, facing: int, offset: float) -> PlanPlane:
        return PlanPlane(f"P{number}", axis, facing, offset, 0.004, ((X0, X5), (Y0, Y5), (0.0, 2.64)), (number,), 40)

    return plane(1, 0, 1, X0), plane(2, 0, -1, X5), plane(3, 1, 1, Y0), plane(4, 1, -1, Y5), plane(5, 2, 1, 0.0), plane(6, 2, -1, 2.642)


def _trajectory() -> Trajectory:
    corners = np.array([[1.0, 4.5], [12.4, 4.5], [12.4, 7.1], [1.0, 7.1], [1.0, 4.5]])
    along = np.linspace(0.0, 4.0, 81)
    xy = np.stack([np.interp(along, np.arange(5), corners[:, axis]) for axis in range(2)], axis=1)
    position = np.column_stack([xy, np.full(len(xy), 1.5)])
    return Trajectory(np.arange(len(xy)) * 100_000_000, position, np.tile(np.eye(3), (len(xy), 1, 1)))


def sample_plan() -> Plan:
    """One floor of 13.4 x 12 m."""
    planes = _planes()
    faces = (Face("F1", "P3", (X0, Y0), (X5, Y0), Certainty.SEEN, 0.0, 2.6), Face("F2", "P2", (X5, Y0), (X5, Y3), Certainty.SEEN))
    rng = np.random.default_rng(7)
    return Plan(
        planes=planes,
        faces=faces,
        walls=_walls(),
        trajectory=_trajectory(),
        rotation_quarters=0,
        shift_m=np.zeros(3),
        free_lines=(FreeLine("L1", (6.12, Y5), (X5, 10.6), 0.02, 10.9, 0.1, 2.5),),
        glazing=(Glazing("G1", (9.2, Y0), (12.6, Y0)),),
        openings=_openings(),
        rooms=_rooms(),
        columns=(Column("C1", _box(6.8, 10.2, 7.15, 10.55)),),
        dimensions=_dimensions(),
        gross_outline=(((-SKIN, -SKIN), (X5 + SKIN, -SKIN), (X5 + SKIN, 10.6), (6.0, Y5 + SKIN), (-SKIN, Y5 + SKIN)),),
        plane_covariance_m2=np.diag(np.full(len(planes), 0.004**2)),
        evidence_xy_m=rng.uniform((0, 0), (13.4, 0.01), size=(200, 2)),
        rejections=(Rejection("seen over the top", 4, 5.2), Rejection("too short", 11, 2.9)),
        notes=("Room R6 was seen through a passage only; its north side is a line outside the Manhattan model.",),
        floor_seen=True,
        level="Ground floor",
    )
