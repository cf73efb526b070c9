import json
from pathlib import Path

import numpy as np
import pytest

from floorplan.config import IngestConfig, ReadConfig
from floorplan.errors import InputError
from floorplan.ingest import ingest
from floorplan.inspection import inspect_scan
from floorplan.readers import open_scan
from tests.readers.folders import HEIGHT, WIDTH, Walk, write_png, write_tum


@pytest.mark.parametrize("units", [1.0, 1e7])
def test_rooms_of_a_kilometre_or_a_millimetre_are_refused_with_the_scale_that_fits(tmp_path: Path, units: float) -> None:
    folder = write_tum(tmp_path, Walk(), units_per_metre=1000.0)
    lens = json.loads((folder / "intrinsics.json").read_text())
    (folder / "intrinsics.json").write_text(json.dumps({**lens, "depth_scale": units}))
    with pytest.raises(InputError, match=r"depth-unit: .*wrong depth unit.*with 1000 it would be 1\.1"):
        ingest(open_scan(folder, config=ReadConfig(world_up="+z")), IngestConfig())
    mended = ingest(open_scan(folder, config=ReadConfig(world_up="+z", depth_scale=1000.0)), IngestConfig())
    assert [p.code for p in mended.recording.problems] == []


def test_a_doubtful_unit_is_mentioned_but_used(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk(), units_per_metre=1000.0)
    facts = inspect_scan(open_scan(folder, config=ReadConfig(world_up="+z", depth_scale=5000.0)), IngestConfig())
    assert [(p.code, p.fatal) for p in facts.problems] == [("depth-unit", False)]
    assert facts.usable


def test_images_without_any_depth_are_fatal_and_info_lists_it(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    for i in range(12):
        write_png(folder / f"depth/{i}.png", np.zeros((HEIGHT, WIDTH), dtype=np.uint16))
    facts = inspect_scan(open_scan(folder, config=ReadConfig(world_up="+z")), IngestConfig())
    assert [(p.code, p.fatal) for p in facts.problems] == [("depth-empty", True)]
    assert not facts.usable
