"""Whether this machine has what the product needs: each answer with what to do about it."""

import importlib
import os
import platform
import shutil
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from floorplan.open3d_library import load_open3d

OLDEST_PYTHON = (3, 11)
LIBRARIES = ("numpy", "scipy", "numba", "cvxpy", "clarabel", "cv2", "shapely", "ezdxf", "matplotlib", "jinja2", "rich", "rosbags")
USEFUL_FREE_BYTES = 2_000_000_000  # the stages of an hour's recording


@dataclass(frozen=True)
class Check:
    """One thing looked at: `found` says what there is, `advice` what to do when it is not `good`."""

    name: str
    good: bool
    found: str
    advice: str = ""


def examine(folder: Path) -> tuple[Check, ...]:
    """Every check; `folder` is where work folders would go."""
    libraries = tuple(_loaded(name, partial(importlib.import_module, name)) for name in LIBRARIES)
    return (_python(), *libraries, _loaded("open3d", load_open3d), _processors(), _disk(folder), _writable(Path(tempfile.gettempdir())))


def _python() -> Check:
    wanted = ".".join(map(str, OLDEST_PYTHON))
    return Check("python", sys.version_info >= OLDEST_PYTHON, platform.python_version(), f"use Python {wanted} or newer")


def _loaded(name: str, load: Callable[[], object]) -> Check:
    """Imported for real: a library can be installed and still lack a system library."""
    try:
        module = load()
    except (ImportError, OSError) as error:
        return Check(name, False, str(error), f"install it again: pip install --force-reinstall {name}")
    return Check(name, True, str(getattr(module, "__version__", "present")))


def _processors() -> Check:
    return Check("processors", True, str(os.cpu_count()))


def _disk(folder: Path) -> Check:
    free = shutil.disk_usage(folder).free
    found = f"{free / 1e9:.1f} GB at {folder}"
    return Check("free disk", free > USEFUL_FREE_BYTES, found, "free some space, or build with --work elsewhere")


def _writable(folder: Path) -> Check:
    return Check("temporary files", os.access(folder, os.W_OK), str(folder), "set TMPDIR to a folder that can be written")
