"""Back-projection, strides, damaged images: what all depth image folders share."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from floorplan.config import IngestConfig
from floorplan.errors import InputError
from floorplan.ingest import ingest
from floorplan.model.scan import Frame, Intrinsics
from floorplan.readers import BadFrame, open_scan
from floorplan.readers.depth_images import scaled_intrinsics
from tests.readers.folders import CX, CY, FX, FY, HEIGHT, WIDTH, Walk, slanted_depth, write_png, write_tum


def only_frame(folder: Path, index: int = 0, stride: int = 1) -> Frame:
    (frame,) = open_scan(folder).frames([index], stride)
    assert isinstance(frame, Frame)
    return frame


def test_points_project_back_to_their_pixels_at_their_depth(tmp_path: Path) -> None:
    points = only_frame(write_tum(tmp_path, Walk())).points.astype(np.float64)
    v, u = np.mgrid[:HEIGHT, :WIDTH]
    seen = slanted_depth() > 0
    assert np.isnan(points[~seen]).all()
    assert np.isfinite(points[seen]).all()
    x, y, z = points[seen].T
    np.testing.assert_allclose(z, slanted_depth()[seen], atol=1.1e-4)  # half a depth unit
    np.testing.assert_allclose(FX * x / z + CX, u[seen], atol=1e-3)
    np.testing.assert_allclose(FY * y / z + CY, v[seen], atol=1e-3)


@pytest.mark.parametrize("stride", [2, 3, 5])
def test_a_stride_gives_exactly_the_pixels_of_the_full_image(tmp_path: Path, stride: int) -> None:
    folder = write_tum(tmp_path, Walk())
    np.testing.assert_array_equal(only_frame(folder, stride=stride).points, only_frame(folder).points[::stride, ::stride])


def test_threads_with_iterators_of_their_own_get_what_one_gets(tmp_path: Path) -> None:
    source = open_scan(write_tum(tmp_path, Walk()))
    alone = [f.points for f in source.frames(range(12)) if isinstance(f, Frame)]
    with ThreadPoolExecutor(4) as pool:
        runs = list(pool.map(lambda _: [f.points for f in source.frames(range(12)) if isinstance(f, Frame)], range(4)))
    for run in runs:
        np.testing.assert_array_equal(run, alone)


def test_half_pixels_survive_scaling_intrinsics_down_and_up() -> None:
    colour = Intrinsics(1920, 1440, 1352.0, 1350.0, 962.0, 722.9)
    depth = scaled_intrinsics(colour, 256, 192)
    # the ray through the image's left edge (-0.5 in whole-number centres) is the same in both
    assert (-0.5 - depth.cx) / depth.fx == pytest.approx((-0.5 - colour.cx) / colour.fx, abs=1e-12)
    assert (191.5 - depth.cy) / depth.fy == pytest.approx((1439.5 - colour.cy) / colour.fy, abs=1e-12)
    assert scaled_intrinsics(depth, 1920, 1440).cx == pytest.approx(colour.cx)


def test_cut_off_and_foreign_images_are_counted_and_left_out(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    whole = (folder / "depth/3.png").read_bytes()
    (folder / "depth/3.png").write_bytes(whole[: len(whole) // 2])
    (folder / "depth/5.png").write_bytes(b"")
    write_png(folder / "depth/7.png", np.zeros((10, 10), dtype=np.uint16))
    (folder / "depth/9.png").unlink()
    recording = open_scan(folder).recording
    found = {p.code: p for p in recording.problems}
    assert len(recording) == 8
    assert found["png-unreadable"].count == 3
    assert found["png-unreadable"].where.endswith("3.png")
    assert found["frame-missing"].count == 1


def test_an_image_damaged_in_its_middle_is_a_bad_frame_that_names_the_file(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    data = bytearray((folder / "depth/4.png").read_bytes())
    data[40:200] = bytes(160)
    (folder / "depth/4.png").write_bytes(bytes(data))
    frames = list(open_scan(folder).frames(range(12)))
    assert [f.index for f in frames if isinstance(f, BadFrame)] == [4]
    assert next(f.problem.where for f in frames if isinstance(f, BadFrame)).endswith("4.png")


def test_a_recording_with_too_many_damaged_images_is_refused(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    for i in range(4):
        (folder / f"depth/{i}.png").write_bytes(b"no image")
    with pytest.raises(InputError, match="too-many-unreadable: 4 of 12"):
        ingest(open_scan(folder), IngestConfig())


def test_a_folder_without_one_16_bit_image_says_so(tmp_path: Path) -> None:
    folder = write_tum(tmp_path, Walk())
    for i in range(12):
        write_png(folder / f"depth/{i}.png", np.ones((HEIGHT, WIDTH), dtype=np.uint8))
    with pytest.raises(InputError, match="16-bit"):
        open_scan(folder)
