"""The plan as IFC4: storeys with walls, spaces, doors, windows and columns, each with its accuracy."""

from collections import defaultdict
from typing import Any

from shapely import Polygon, box, union_all

from floorplan.config import ProjectConfig
from floorplan.model.normal import NORMAL_95
from floorplan.model.plan import Column, Opening, OpeningKind, Plan, Point, Room, Wall
from floorplan.writers.facts import SheetFacts
from floorplan.writers.ifc_model import ACCURACY_SET, Entity, IfcModel, Value

ASSUMED_HEIGHT_M = 2.5  # only where no height of the storey was measured at all; `HeightMeasured` says so
CUT_BEYOND_M = 0.05  # an opening's body stands out of its wall, so that nothing of the wall stays in it
FRAME_DEPTH_M = 0.05  # drawn depth of a door or window: the frame was not measured
SNAP_M = 1e-4  # bodies nearer than this are one
PREDEFINED = {"IfcSpace": "INTERNAL", "IfcWall": "NOTDEFINED", "IfcDoor": "DOOR", "IfcWindow": "WINDOW", "IfcColumn": "COLUMN"}


def ifc_bytes(plan: Plan, project: ProjectConfig, facts: SheetFacts) -> bytes:
    """The file; raises UsageError where ifcopenshell is missing."""
    model = IfcModel(facts.scan)
    name = project.name or facts.scan or "Floor plan"
    root = model.project(project, name, plan.site)
    site = model.rooted("IfcSite", "site", Name=project.address or None, ObjectPlacement=model.placement(), CompositionType="ELEMENT")
    building = model.rooted(
        "IfcBuilding", "building", Name=name, ObjectPlacement=model.placement(relative_to=site.ObjectPlacement), CompositionType="ELEMENT"
    )
    storeys = [_Storey(model, storey, building.ObjectPlacement, project).made() for storey in plan.storeys]
    model.scope = ""
    for whole, parts in ((root, [site]), (site, [building]), (building, storeys)):
        model.rooted("IfcRelAggregates", whole.GlobalId, RelatingObject=whole, RelatedObjects=parts)
    return model.bytes(facts.date, facts.software, f"{name}.ifc")


class _Storey:
    """One storey while it is made."""

    def __init__(self, model: IfcModel, plan: Plan, building: Entity, project: ProjectConfig) -> None:
        self.model, self.plan = model, plan
        model.scope = plan.level if plan.elevation_m else ""
        self.place = model.placement(z=plan.elevation_m, relative_to=building)
        name = plan.level or project.floor or "Storey"
        self.entity = model.rooted(
            "IfcBuildingStorey", name, Name=name, ObjectPlacement=self.place, CompositionType="ELEMENT", Elevation=float(plan.elevation_m)
        )
        heights = [room.ceiling_height_m for room in plan.rooms if room.ceiling_height_m] + [w.height_m for w in plan.walls if w.height_m]
        self.height_m = max(heights, default=ASSUMED_HEIGHT_M)
        self.contained: list[Entity] = []

    def made(self) -> Entity:
        hosts = self._walls()
        for opening in self.plan.openings:
            self._opening(opening, hosts)
        for line in self.plan.free_lines:
            wall = self._product("IfcWall", line.id, self.model.sheet_shape([(line.start, line.end)], 0.0, line.high_m or self.height_m))
            self._accuracy(wall, line.id, PositionPlusMinus95=_length(line.sigma_m), OffAxisDegrees=("IfcReal", line.off_axis_deg))
        for pane in self.plan.glazing:
            self._product("IfcCurtainWall", pane.id, self.model.sheet_shape([(pane.start, pane.end)], 0.0, self.height_m))
        for column in self.plan.columns:
            self._column(column)
        spaces = [self._space(room) for room in self.plan.rooms]
        if spaces:
            self.model.rooted("IfcRelAggregates", self.entity.GlobalId, RelatingObject=self.entity, RelatedObjects=spaces)
        if self.contained:
            self.model.rooted(
                "IfcRelContainedInSpatialStructure",
                self.entity.GlobalId,
                RelatedElements=self.contained,
                RelatingStructure=self.entity,
            )
        return self.entity

    def _product(self, kind: str, identity: str, shape: Entity, contained: bool = True, **more: Any) -> Entity:
        if kind in PREDEFINED:
            more["PredefinedType"] = PREDEFINED[kind]
        place = self.model.placement(relative_to=self.place)
        made = self.model.rooted(kind, identity, Name=identity, ObjectPlacement=place, Representation=shape, **more)
        if contained:
            self.contained.append(made)
        return made

    def _accuracy(self, product: Entity, ids: str, **values: tuple[str, Value] | None) -> None:
        self.model.properties(product, ACCURACY_SET, {"PlanIds": ("IfcLabel", ids), **values})

    def _walls(self) -> dict[str, Entity]:
        """Walls with two faces, those that an opening joins as one; and single faces as sheets. Wall id to its entity, for openings."""
        hosts: dict[str, Entity] = {}
        for group in _joined(self.plan):
            entity = self._solid_wall(group)
            hosts |= {wall.id: entity for wall in group}
        for wall in self.plan.walls:
            if not wall.fill and (wall.seen or wall.inferred):
                top = wall.height_m or self.height_m
                sheet = self._product("IfcWall", wall.id, self.model.sheet_shape((*wall.seen, *wall.inferred), 0.0, top))
                self._accuracy(sheet, wall.id, HeightMeasured=("IfcBoolean", wall.height_m is not None))
        return hosts

    def _solid_wall(self, group: tuple[Wall, ...]) -> Entity:
        ids = {wall.id for wall in group}
        joins = [_footprint(o) for o in self.plan.openings if o.depth_m > 0 and ids & set(o.walls)]
        body = union_all([Polygon(wall.fill) for wall in group] + joins, grid_size=SNAP_M)
        measured = [wall.height_m for wall in group if wall.height_m]
        height = max(measured, default=self.height_m)
        prisms = [self.model.prism(part, height) for part in getattr(body, "geoms", [body])]
        name = ", ".join(wall.id for wall in group)
        entity = self._product("IfcWall", name, self.model.solid_shape(prisms))
        worst = max(group, key=lambda wall: wall.thickness_sigma_m or 0.0)
        self._accuracy(
            entity,
            name,
            ThicknessPlusMinus95=None if worst.thickness_sigma_m is None else _length(worst.thickness_sigma_m),
            HeightMeasured=("IfcBoolean", bool(measured)),
        )
        thickness = group[0].thickness_m
        self.model.quantities(
            entity, "Qto_WallBaseQuantities", {"Width": None if thickness is None else ("Length", thickness), "Height": ("Length", height)}
        )
        return entity

    def _opening(self, opening: Opening, hosts: dict[str, Entity]) -> None:
        """A void in its wall, filled by a door or a window; a passage stays a void. A wall known from one side has nothing to cut."""
        host = next((hosts[wall] for wall in opening.walls if wall in hosts), None) if opening.depth_m > 0 else None
        sill = opening.sill_height_m or 0.0
        top = opening.head_height_m or self.height_m
        void = None
        if host is not None:
            cut = _footprint(opening, CUT_BEYOND_M)
            body = self.model.solid_shape([self.model.prism(cut, top - sill, sill)])
            void = self._product("IfcOpeningElement", f"{opening.id} opening", body, contained=False, PredefinedType="OPENING")
            self.model.rooted("IfcRelVoidsElement", opening.id, RelatingBuildingElement=host, RelatedOpeningElement=void)
        if opening.kind is OpeningKind.PASSAGE:
            return
        kind = "IfcDoor" if opening.kind is OpeningKind.DOOR else "IfcWindow"
        shape = self.model.solid_shape([self.model.prism(_leaf(opening), top - sill, sill)])
        filling = self._product(kind, opening.id, shape, OverallWidth=float(opening.width_m), OverallHeight=float(top - sill))
        self._accuracy(
            filling,
            opening.id,
            WidthPlusMinus95=_length(opening.width_sigma_m),
            HeightMeasured=("IfcBoolean", opening.head_height_m is not None),
        )
        if void is not None:
            self.model.rooted("IfcRelFillsElement", opening.id, RelatingOpeningElement=void, RelatedBuildingElement=filling)

    def _column(self, column: Column) -> None:
        self._product("IfcColumn", column.id, self.model.solid_shape([self.model.prism(Polygon(column.outline), self.height_m)]))

    def _space(self, room: Room) -> Entity:
        height = room.ceiling_height_m or self.height_m
        shape = self.model.solid_shape([self.model.prism(Polygon(room.outline, room.holes), height)])
        space = self._product("IfcSpace", room.id, shape, contained=False, LongName=room.name or None, CompositionType="ELEMENT")
        self._accuracy(
            space,
            room.id,
            AreaPlusMinus95=None if room.partial else ("IfcAreaMeasure", NORMAL_95 * room.area_sigma_m2),
            CeilingHeightPlusMinus95=None if room.ceiling_sigma_m is None else _length(room.ceiling_sigma_m),
            HeightMeasured=("IfcBoolean", room.ceiling_height_m is not None),
            PartlySeen=("IfcBoolean", room.partial),
        )
        measured = None if room.ceiling_height_m is None else ("Length", room.ceiling_height_m)
        self.model.quantities(space, "Qto_SpaceBaseQuantities", {"NetFloorArea": ("Area", room.area_m2), "Height": measured})
        return space


def _length(sigma_m: float) -> tuple[str, Value]:
    return "IfcLengthMeasure", NORMAL_95 * sigma_m


def _joined(plan: Plan) -> list[tuple[Wall, ...]]:
    """Walls with two faces in groups: those that an opening stands between are one wall."""
    group = {wall.id: index for index, wall in enumerate(plan.walls) if wall.fill}
    for opening in plan.openings:
        met = [group[wall] for wall in opening.walls if wall in group] if opening.depth_m > 0 else []
        group = {wall: min(met) if index in met else index for wall, index in group.items()}
    groups: dict[int, list[Wall]] = defaultdict(list)
    for wall in plan.walls:
        if wall.id in group:
            groups[group[wall.id]].append(wall)
    return [tuple(walls) for walls in groups.values()]


def _footprint(opening: Opening, beyond_m: float = 0.0) -> Polygon:
    """The opening's rectangle in the wall, `beyond_m` deeper on both sides."""
    return _rectangle(opening.centre, opening.along_axis, opening.width_m, opening.depth_m + 2 * beyond_m)


def _leaf(opening: Opening) -> Polygon:
    return _rectangle(opening.centre, opening.along_axis, opening.width_m, FRAME_DEPTH_M)


def _rectangle(centre: Point, along_axis: int, width: float, depth: float) -> Polygon:
    dx, dy = (width / 2, depth / 2) if along_axis == 0 else (depth / 2, width / 2)
    return box(centre[0] - dx, centre[1] - dy, centre[0] + dx, centre[1] + dy)
