"""Fixtures shared by all tests."""

import os
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real recordings: `FLOORPLAN_DATA`, else `../shared/data` beside the checkout; the test skips without it."""
    default = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("FLOORPLAN_DATA", default))
    if not folder.is_dir():
        pytest.skip(f"no real recordings at {folder} (set FLOORPLAN_DATA)")
    return folder
