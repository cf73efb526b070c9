"""The same plan gives the same files in every process: nothing depends on the order of a set."""

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

SCRIPT = """
import sys
from pathlib import Path
from floorplan import writers
from floorplan.config import DrawingConfig, ProjectConfig
from tests.sample_plan import sample_plan
folder = Path(sys.argv[1])
folder.mkdir()
for name in sys.argv[2:]:
    job = writers.Job(sample_plan(), DrawingConfig(), ProjectConfig(), writers.SheetFacts("sample", "2026-03-04", "floorplan"))
    writers.write_job(name, job, folder / name)
"""
ROOT = Path(__file__).resolve().parents[2]


def test_files_do_not_depend_on_the_hash_seed(tmp_path: Path) -> None:
    names = ["dxf", "svg", "pdf", "png", "json", "geojson", "dimensions", "rooms", "report"]
    names += ["ifc"] if find_spec("ifcopenshell") else []
    for seed in ("1", "2"):
        command = [sys.executable, "-c", SCRIPT, str(tmp_path / seed), *names]
        subprocess.run(command, cwd=ROOT, env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)}, check=True)
    differing = [name for name in names if (tmp_path / "1" / name).read_bytes() != (tmp_path / "2" / name).read_bytes()]
    assert differing == []
