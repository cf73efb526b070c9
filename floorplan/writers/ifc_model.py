"""An IFC4 file with what every product in it needs: units, contexts, placements, bodies, properties; same input, same bytes."""

import math
import uuid
from collections.abc import Iterable, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from shapely import Polygon
from shapely.geometry.polygon import orient

from floorplan.config import ProjectConfig
from floorplan.errors import UsageError
from floorplan.model.plan import Point
from floorplan.model.site import Site

if TYPE_CHECKING:
    from ifcopenshell import file as IfcFile  # noqa: N812 - the library's own name

ACCURACY_SET = "Pset_FloorplanAccuracy"
NAMESPACE = uuid.UUID("7f2c1c1e-6f0e-5a53-9d2b-0c4f6f1f2a10")  # of our identifiers: any constant
PRECISION_M = 1e-5
DIGITS = 6  # of a metre written: a micrometre
UNNAMED_CRS = "site grid"
UNKNOWN_TIME = "2000-01-01T00:00:00"  # where the recording's date is not known
Entity = Any  # an ifcopenshell entity: the library has no types
Value = str | float | bool


def need_ifcopenshell() -> None:
    """Raises UsageError that names the extra when ifcopenshell is not installed."""
    from importlib.util import find_spec

    if find_spec("ifcopenshell") is None:
        raise UsageError("IFC needs the optional extra 'ifc': pip install 'manhattan-floorplan[ifc]' (it brings ifcopenshell)")


class IfcModel:
    """The file while it is made; `key` (the scan's name) makes identifiers its own."""

    def __init__(self, key: str) -> None:
        need_ifcopenshell()
        import ifcopenshell

        self.file: IfcFile = ifcopenshell.file(schema="IFC4")
        self.key = key
        self.scope = ""  # the storey that is being made: glazing and columns are numbered by storey
        self.plan_context: Entity = None
        self.body: Entity = None
        self.axis: Entity = None

    def make(self, kind: str, **attributes: Any) -> Entity:
        return self.file.create_entity(kind, **attributes)

    def rooted(self, kind: str, identity: str, **attributes: Any) -> Entity:
        """An entity with a GlobalId that stays the same from build to build."""
        import ifcopenshell.guid

        guid = ifcopenshell.guid.compress(uuid.uuid5(NAMESPACE, f"{self.key}/{self.scope}/{kind}/{identity}").hex)
        return self.make(kind, GlobalId=guid, **attributes)

    def direction(self, *ratios: float) -> Entity:
        return self.make("IfcDirection", DirectionRatios=[float(r) for r in ratios])

    def point(self, *coordinates: float) -> Entity:
        return self.make("IfcCartesianPoint", Coordinates=[round(float(c), DIGITS) + 0.0 for c in coordinates])

    def placement(self, x: float = 0.0, y: float = 0.0, z: float = 0.0, relative_to: Entity = None, along: Point = (1.0, 0.0)) -> Entity:
        """A local placement whose x runs along `along`."""
        axes = self.make(
            "IfcAxis2Placement3D", Location=self.point(x, y, z), Axis=self.direction(0, 0, 1), RefDirection=self.direction(*along, 0)
        )
        return self.make("IfcLocalPlacement", PlacementRelTo=relative_to, RelativePlacement=axes)

    def polyline(self, points: Iterable[Point]) -> Entity:
        return self.make("IfcPolyline", Points=[self.point(*p) for p in points])

    def prism(self, polygon: Polygon, height_m: float, from_m: float = 0.0) -> Entity:
        """A polygon, with its holes, extruded upwards."""
        shape = orient(polygon)
        outer = self.polyline(shape.exterior.coords)
        inner = [self.polyline(ring.coords) for ring in shape.interiors]
        kind = "IfcArbitraryProfileDefWithVoids" if inner else "IfcArbitraryClosedProfileDef"
        profile = self.make(kind, ProfileType="AREA", OuterCurve=outer, **({"InnerCurves": inner} if inner else {}))
        at = self.make("IfcAxis2Placement3D", Location=self.point(0, 0, from_m))
        return self.make(
            "IfcExtrudedAreaSolid", SweptArea=profile, Position=at, ExtrudedDirection=self.direction(0, 0, 1), Depth=float(height_m)
        )

    def solid_shape(self, solids: list[Entity]) -> Entity:
        return self._shape(
            [
                self.make(
                    "IfcShapeRepresentation",
                    ContextOfItems=self.body,
                    RepresentationIdentifier="Body",
                    RepresentationType="SweptSolid",
                    Items=solids,
                )
            ]
        )

    def sheet_shape(self, lines: Iterable[tuple[Point, ...]], low_m: float, high_m: float) -> Entity:
        """Upright faces over plan lines, without thickness: the side of a wall that was seen, nothing invented behind it."""
        lines = [line for line in lines if len(line) > 1]
        quads = [(a, b) for line in lines for a, b in pairwise(line)]
        faces = [self._face([(*a, low_m), (*b, low_m), (*b, high_m), (*a, high_m)]) for a, b in quads]
        shell = self.make("IfcFaceBasedSurfaceModel", FbsmFaces=[self.make("IfcConnectedFaceSet", CfsFaces=faces)])
        body = self.make(
            "IfcShapeRepresentation",
            ContextOfItems=self.body,
            RepresentationIdentifier="Body",
            RepresentationType="SurfaceModel",
            Items=[shell],
        )
        curves = [self.polyline(line) for line in lines[:1]]
        axis = self.make(
            "IfcShapeRepresentation", ContextOfItems=self.axis, RepresentationIdentifier="Axis", RepresentationType="Curve2D", Items=curves
        )
        return self._shape([axis, body])

    def _face(self, corners: list[tuple[float, float, float]]) -> Entity:
        loop = self.make("IfcPolyLoop", Polygon=[self.point(*corner) for corner in corners])
        return self.make("IfcFace", Bounds=[self.make("IfcFaceOuterBound", Bound=loop, Orientation=True)])

    def _shape(self, representations: list[Entity]) -> Entity:
        return self.make("IfcProductDefinitionShape", Representations=representations)

    def properties(self, product: Entity, name: str, values: Mapping[str, tuple[str, Value] | None]) -> None:
        """A property set: name to (IFC measure, value); what is None is not known and left out."""
        known = {key: value for key, value in values.items() if value is not None}
        if not known:
            return
        single = [
            self.make("IfcPropertySingleValue", Name=key, NominalValue=self.file.create_entity(measure, value))
            for key, (measure, value) in known.items()
        ]
        identity = f"{product.is_a()}/{product.GlobalId}/{name}"
        told = self.rooted("IfcPropertySet", identity, Name=name, HasProperties=single)
        self.rooted("IfcRelDefinesByProperties", identity, RelatedObjects=[product], RelatingPropertyDefinition=told)

    def quantities(self, product: Entity, name: str, values: Mapping[str, tuple[str, float] | None]) -> None:
        """A quantity set: name to (`Length` or `Area`, value)."""
        known = {key: value for key, value in values.items() if value is not None}
        made = [self.make(f"IfcQuantity{kind}", Name=key, **{f"{kind}Value": float(value)}) for key, (kind, value) in known.items()]
        if made:
            identity = f"{product.is_a()}/{product.GlobalId}/{name}"
            told = self.rooted("IfcElementQuantity", identity, Name=name, Quantities=made)
            self.rooted("IfcRelDefinesByProperties", identity, RelatedObjects=[product], RelatingPropertyDefinition=told)

    def project(self, project: ProjectConfig, name: str, site: Site | None) -> Entity:
        """The project with metres, contexts, true north and, where control points were given, its place on the site grid."""
        units = [
            self.make("IfcSIUnit", UnitType=kind, Name=unit)
            for kind, unit in (
                ("LENGTHUNIT", "METRE"),
                ("AREAUNIT", "SQUARE_METRE"),
                ("VOLUMEUNIT", "CUBIC_METRE"),
                ("PLANEANGLEUNIT", "RADIAN"),
            )
        ]
        north = None if project.north_deg is None else math.radians(project.north_deg)
        world = self.make("IfcAxis2Placement3D", Location=self.point(0, 0, 0))
        true_north = None if north is None else self.direction(-math.sin(north), math.cos(north))
        self.plan_context = self.make(
            "IfcGeometricRepresentationContext",
            ContextType="Model",
            CoordinateSpaceDimension=3,
            Precision=PRECISION_M,
            WorldCoordinateSystem=world,
            TrueNorth=true_north,
        )
        self.body, self.axis = (self._sub_context(word, view) for word, view in (("Body", "MODEL_VIEW"), ("Axis", "GRAPH_VIEW")))
        self._map_conversion(site, project.map_crs)
        assignment = self.make("IfcUnitAssignment", Units=units)
        return self.rooted("IfcProject", "project", Name=name, RepresentationContexts=[self.plan_context], UnitsInContext=assignment)

    def _sub_context(self, identifier: str, view: str) -> Entity:
        return self.make(
            "IfcGeometricRepresentationSubContext",
            ContextIdentifier=identifier,
            ContextType="Model",
            ParentContext=self.plan_context,
            TargetView=view,
        )

    def _map_conversion(self, site: Site | None, crs: str) -> None:
        """Where the plan's origin lies on the site grid, and which way its x runs there; nothing for a north angle alone."""
        if site is None or not site.points:
            return
        turn = math.radians(site.rotation_deg)
        self.make(
            "IfcMapConversion",
            SourceCRS=self.plan_context,
            TargetCRS=self.make("IfcProjectedCRS", Name=crs or UNNAMED_CRS),
            Eastings=float(site.east_m),
            Northings=float(site.north_m),
            OrthogonalHeight=0.0,
            XAxisAbscissa=math.cos(turn),
            XAxisOrdinate=math.sin(turn),
            Scale=1.0,
        )

    def bytes(self, recorded: str, software: str, title: str) -> bytes:
        """The file as text (STEP); its time is the recording's, never the clock's."""
        header = self.file.header
        header.file_name.name = title
        header.file_name.time_stamp = f"{recorded[:10]}T00:00:00" if recorded else UNKNOWN_TIME
        header.file_name.preprocessor_version = software
        header.file_name.originating_system = software
        text: str = self.file.to_string()  # type: ignore[no-untyped-call]
        return text.encode("utf-8")
