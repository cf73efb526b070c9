"""The IFC model is valid, and its bodies stand where the plan has them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from shapely import Polygon, box, union_all

from floorplan.config import DrawingConfig, ProjectConfig
from floorplan.drawings import Drawing, check_drawings
from floorplan.errors import UsageError
from floorplan.model.plan import OpeningKind, Plan
from floorplan.model.site import ControlPoint, Site
from floorplan.plan.storeys import stacked
from floorplan.writers import SheetFacts, write
from floorplan.writers.ifc import ifc_bytes
from tests.sample_plan import SKIN, Y0, sample_plan

FACTS = SheetFacts(scan="sample", date="2026-03-04", software="floorplan 0.1.0")
TENTH_OF_A_MM = 1e-4


def model_of(plan: Plan, project: ProjectConfig | None = None):  # type: ignore[no-untyped-def]
    ifcopenshell = pytest.importorskip("ifcopenshell", reason="the optional extra 'ifc' is not installed")
    return ifcopenshell.file.from_string(ifc_bytes(plan, project or ProjectConfig(), FACTS).decode("utf-8"))


def two_storeys() -> Plan:
    plan = sample_plan()
    return stacked((plan, replace(plan, shift_m=np.array([0.0, 0.0, -2.95]))))


def footprint(product) -> Polygon:  # type: ignore[no-untyped-def]
    """The union of a product's swept areas, from the curves in the file."""
    body = next(r for r in product.Representation.Representations if r.RepresentationIdentifier == "Body")
    shapes = []
    for solid in body.Items:
        area = solid.SweptArea
        holes = [[p.Coordinates for p in ring.Points] for ring in getattr(area, "InnerCurves", None) or ()]
        shapes.append(Polygon([p.Coordinates for p in area.OuterCurve.Points], holes))
    return union_all(shapes)


def accuracy(product) -> dict[str, object]:  # type: ignore[no-untyped-def]
    found = {}
    for relation in product.IsDefinedBy:
        told = relation.RelatingPropertyDefinition
        if told.is_a("IfcPropertySet") and told.Name == "Pset_FloorplanAccuracy":
            found |= {p.Name: p.NominalValue.wrappedValue for p in told.HasProperties}
    return found


@pytest.mark.parametrize("plan", [sample_plan(), two_storeys()], ids=["one storey", "two storeys"])
def test_the_file_keeps_the_schema_and_its_rules(plan: Plan) -> None:
    model = model_of(plan)
    validate = pytest.importorskip("ifcopenshell.validate")
    logger = validate.json_logger()
    validate.validate(model, logger, express_rules=False)
    assert logger.statements == []
    assert model.schema == "IFC4"


def test_the_same_plan_gives_the_same_bytes() -> None:
    pytest.importorskip("ifcopenshell", reason="the optional extra 'ifc' is not installed")
    assert ifc_bytes(two_storeys(), ProjectConfig(), FACTS) == ifc_bytes(two_storeys(), ProjectConfig(), FACTS)


def test_walls_are_read_back_where_they_stand() -> None:
    """Solid walls together are the plan's fills and the openings between them, to a tenth of a millimetre."""
    plan = sample_plan()
    walls = [wall for wall in model_of(plan).by_type("IfcWall") if footprint_kind(wall) == "SweptSolid"]
    read = union_all([footprint(wall) for wall in walls])
    fills = union_all([Polygon(wall.fill) for wall in plan.walls if wall.fill])
    assert fills.difference(read.buffer(TENTH_OF_A_MM)).area < 1e-9
    gaps = [box(o.centre[0] - o.width_m / 2, o.centre[1] - 0.06, o.centre[0] + o.width_m / 2, o.centre[1] + 0.06) for o in plan.openings]
    assert read.difference(union_all([fills, *gaps, box(4.0, 2.0, 4.2, 3.1)]).buffer(TENTH_OF_A_MM)).area < 1e-9


def footprint_kind(product) -> str:  # type: ignore[no-untyped-def]
    return next(str(r.RepresentationType) for r in product.Representation.Representations if r.RepresentationIdentifier == "Body")


def test_a_wall_has_its_height_and_says_how_well_its_thickness_is_known() -> None:
    model = model_of(sample_plan())
    wall = next(wall for wall in model.by_type("IfcWall") if wall.Name == "W1")
    body = next(r for r in wall.Representation.Representations if r.RepresentationIdentifier == "Body")
    assert body.Items[0].Depth == pytest.approx(2.64)
    assert accuracy(wall) == {"PlanIds": "W1", "ThicknessPlusMinus95": pytest.approx(1.96 * 0.003), "HeightMeasured": True}
    assert footprint(wall).bounds == pytest.approx((-SKIN, -SKIN, 13.4 + SKIN, Y0), abs=TENTH_OF_A_MM)


def test_a_face_without_partner_has_no_thickness() -> None:
    wall = next(wall for wall in model_of(sample_plan()).by_type("IfcWall") if wall.Name == "W15")
    assert footprint_kind(wall) == "SurfaceModel"


def test_spaces_have_the_net_area_and_the_ceiling() -> None:
    plan, model = sample_plan(), model_of(sample_plan())
    spaces = {space.Name: space for space in model.by_type("IfcSpace")}
    assert set(spaces) == {room.id for room in plan.rooms}
    for room in plan.rooms:
        assert footprint(spaces[room.id]).symmetric_difference(Polygon(room.outline, room.holes)).area < 1e-6
        told = accuracy(spaces[room.id]).get("AreaPlusMinus95")
        assert told is None if room.partial else told == pytest.approx(1.96 * room.area_sigma_m2)
        assert accuracy(spaces[room.id])["PartlySeen"] == room.partial


def test_doors_fill_openings_that_void_their_wall() -> None:
    model = model_of(sample_plan())
    doors = {door.Name: door for door in model.by_type("IfcDoor")}
    assert set(doors) == {o.id for o in sample_plan().openings if o.kind is OpeningKind.DOOR}
    first = doors["O1"]
    void = first.FillsVoids[0].RelatingOpeningElement
    assert set(void.VoidsElements[0].RelatingBuildingElement.Name.split(", ")) >= {"W6", "W7"}
    assert (first.OverallWidth, first.OverallHeight) == pytest.approx((0.9, 2.05))
    assert len(model.by_type("IfcOpeningElement")) == 6  # five doors and a passage; the window is in a wall known from one side


def test_the_kernel_cuts_the_door_out_of_the_wall() -> None:
    model = model_of(sample_plan())
    geom = pytest.importorskip("ifcopenshell.geom")
    shape_tools = pytest.importorskip("ifcopenshell.util.shape")
    host = next(door for door in model.by_type("IfcDoor") if door.Name == "O1").FillsVoids[0].RelatingOpeningElement.VoidsElements[0]
    wall = host.RelatingBuildingElement
    cut = shape_tools.get_volume(geom.create_shape(geom.settings(), wall).geometry)
    cuts = [o for o in sample_plan().openings if o.walls and o.walls[0] in wall.Name.split(", ")]
    holes = sum(o.width_m * o.depth_m * (o.head_height_m or 0.0) for o in cuts)
    assert cut == pytest.approx(footprint(wall).area * 2.64 - holes, rel=1e-3)


def test_storeys_stand_above_each_other() -> None:
    model = model_of(two_storeys())
    assert [(s.Name, round(s.Elevation, 6)) for s in model.by_type("IfcBuildingStorey")] == [("Storey 1", 0.0), ("Storey 2", 2.95)]
    heights = {s.ObjectPlacement.RelativePlacement.Location.Coordinates[2] for s in model.by_type("IfcBuildingStorey")}
    assert heights == {0.0, 2.95}


def test_site_coordinates_place_the_model_on_the_map() -> None:
    point = ControlPoint("A", (0.0, 0.0), (500_000.0, 5_400_000.0), True, (0.0, 0.0))
    site = Site(30.0, 500_000.0, 5_400_000.0, points=(point,))
    model = model_of(replace(sample_plan(), site=site), ProjectConfig(map_crs="EPSG:25832"))
    (conversion,) = model.by_type("IfcMapConversion")
    assert (conversion.Eastings, conversion.Northings) == (500_000.0, 5_400_000.0)
    assert (conversion.XAxisAbscissa, conversion.XAxisOrdinate) == pytest.approx((np.cos(np.radians(30)), 0.5))
    assert conversion.TargetCRS.Name == "EPSG:25832"
    assert site.to_site((1.0, 0.0)) == pytest.approx((500_000 + np.cos(np.radians(30)), 5_400_000.5))


def test_without_the_extra_the_error_names_it_before_any_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(UsageError, match=r"manhattan-floorplan\[ifc\]"):
        check_drawings((Drawing("ifc", tmp_path / "plan.ifc"),))
    with pytest.raises(UsageError, match="optional extra 'ifc'"):
        write("ifc", sample_plan(), tmp_path / "plan.ifc", DrawingConfig(), ProjectConfig(), FACTS)
