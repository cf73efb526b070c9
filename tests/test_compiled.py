"""Machine code is kept wherever there is a place for it, and its lack stops nobody."""

import shutil
import subprocess
import sys
from pathlib import Path

import floorplan

SCRIPT = """
import os, sys
os.access = lambda path, mode: False  # neither the package nor the home can be written
from floorplan import compiled
import numba
@compiled.compiled
def half(x):
    return x / 2

sys.stdout.write(f"{half(3.0)} {numba.config.CACHE_DIR}")
"""


def test_where_nothing_can_be_written_code_is_compiled_for_one_run_and_nothing_stays(tmp_path: Path) -> None:
    package = tmp_path / "floorplan"
    package.mkdir()
    for name in ("__init__.py", "compiled.py"):
        shutil.copy(Path(floorplan.__file__).parent / name, package)
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    said = subprocess.run([sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    value, folder = said.split(" ", 1)
    assert value == "1.5"
    assert "floorplan-" in folder
    assert not Path(folder).exists()
