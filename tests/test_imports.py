"""Imports go one way, heavy libraries have one home each, and nobody below the command line prints or exits."""

import ast
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[1] / "floorplan"
SOURCES = sorted(PACKAGE.rglob("*.py"))
HOMES = {  # the one module, or folder, that may import the library
    "cvxpy": ("merge/paper_cvxpy.py",),
    "clarabel": ("merge/",),
    "open3d": ("open3d_library.py",),
    "libusb_package": ("open3d_library.py",),
    "ezdxf": ("writers/",),
    "ifcopenshell": ("writers/",),
    "matplotlib": ("writers/",),
    "rosbags": ("readers/", "simulate/ros_messages.py"),
    "typer": ("cli/",),
    "rich": ("cli/",),
}
# too slow to import before they are needed
AT_THE_TOP = ("cvxpy", "clarabel", "open3d", "ezdxf", "ifcopenshell", "rosbags", "matplotlib", "rich")
TOP = {"cli", "build", "export", "results", "drawings", "initial_layout", "chunked_segments", "stage_counts", "stage_functions"}
TOP |= {"frame_export", "report", "write_report", "corrections", "plan_names", "merge_table", "solve_graph", "drawing_process", "__main__"}
TOP |= {"build_several", "view", "write_view", "kept_config", "kept_drawings", "placed_points", "compare", "survey_advice"}
OUTSIDE_THE_STAGES = TOP | {"work", "several", "config_file", "doctor", "summary", "simulate", "writers", "readers", "solve"}
GROUND = {"model", "errors", "geometry"}


def name_of(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


def part_of(path: Path) -> str:
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imports(path: Path) -> Iterator[tuple[str, bool]]:
    """Each imported module with its dotted name, and whether the import stands at the top of the file."""
    tree = ast.parse(path.read_text("utf-8"))
    for node in ast.walk(tree):
        top = node in tree.body
        if isinstance(node, ast.Import):
            yield from ((alias.name, top) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            assert node.level == 0, f"{name_of(path)}: relative import"
            if node.module == "floorplan":
                yield from ((f"floorplan.{alias.name}", top) for alias in node.names)
            else:
                yield node.module, top


def parts_imported(path: Path) -> set[str]:
    return {module.split(".")[1] for module, _ in imports(path) if module.startswith("floorplan.")}


@pytest.mark.parametrize("path", SOURCES, ids=name_of)
def test_each_heavy_library_has_one_home_and_is_imported_when_needed(path: Path) -> None:
    for module, top in imports(path):
        library = module.split(".")[0]
        if library in HOMES:
            assert name_of(path).startswith(HOMES[library]), f"{name_of(path)} imports {library}"
        assert not (top and library in AT_THE_TOP), f"{name_of(path)} imports {library} at the top"


@pytest.mark.parametrize("path", [p for p in SOURCES if part_of(p) in GROUND], ids=name_of)
def test_the_ground_floor_imports_only_itself(path: Path) -> None:
    assert parts_imported(path) <= GROUND


@pytest.mark.parametrize("path", [p for p in SOURCES if part_of(p) not in OUTSIDE_THE_STAGES], ids=name_of)
def test_a_stage_knows_no_path_no_cache_no_command_line(path: Path) -> None:
    assert not parts_imported(path) & (TOP | {"work", "writers", "simulate"})


@pytest.mark.parametrize("path", [p for p in SOURCES if part_of(p) == "work"], ids=name_of)
def test_the_work_folder_knows_no_stage_by_what_it_does(path: Path) -> None:
    assert parts_imported(path) <= GROUND | {"work", "reporting"}


def module_of(path: Path) -> str:
    return ".".join(("floorplan", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")


def modules_imported(path: Path, known: set[str]) -> set[str]:
    """Modules of the package that a file imports, at its top or inside a function."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= (names & known) or ({node.module} & known)
    return found - {module_of(path)}


def test_no_modules_import_each_other_in_a_circle() -> None:
    known = {module_of(path) for path in SOURCES}
    left = {module_of(path): modules_imported(path, known) for path in SOURCES}
    while leaves := {module for module, needed in left.items() if not needed & left.keys()}:
        left = {module: needed for module, needed in left.items() if module not in leaves}
    assert not left


@pytest.mark.parametrize("path", [p for p in SOURCES if part_of(p) != "cli"], ids=name_of)
def test_only_the_command_line_prints_exits_and_reads_the_environment(path: Path) -> None:
    text = path.read_text("utf-8")
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            assert node.func.id not in ("print", "input", "exit")
    assert "sys.exit" not in text
    assert "os.environ" not in text


def test_a_build_that_finds_everything_finished_waits_for_no_heavy_library() -> None:
    heavy = ("numba", "scipy", "cvxpy", "open3d", "ezdxf", "matplotlib", "shapely")
    code = f"import sys, floorplan.build; sys.stdout.write(' '.join(name for name in {heavy} if name in sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], cwd=PACKAGE.parent, capture_output=True, text=True, check=True)
    assert done.stdout == ""
