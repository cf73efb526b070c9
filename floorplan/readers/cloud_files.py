"""Point clouds from files: PLY, PCD and KITTI's `.bin`. Lengths in metres, NaN for no return.

Formats: PLY (Turk 1994), PCD 0.7 (pointclouds.org, "The PCD file format"), KITTI: float32 x, y, z, intensity (nuScenes adds the ring).
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.readers.cloud_grid import RING_FIELDS, Cloud

SUFFIXES = (".ply", ".pcd", ".bin")
KITTI_FLOATS, NUSCENES_FLOATS = 4, 5
NUSCENES_SUFFIX = ".pcd.bin"
HEADER_BYTES = 65536  # far more than any header of these formats
PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip
PLY_ORDERS = {"binary_little_endian": "<", "binary_big_endian": ">"}


@dataclass(frozen=True)
class _Layout:
    """What a header says: numpy type of a point, how many, rows of an organised cloud (1: none), how the data are written and where
    they begin."""

    dtype: "np.dtype[np.void]"
    count: int
    height: int
    data: str
    start: int


def read_cloud(path: Path) -> Cloud:
    """The cloud in a file. Raises `InputError` naming the file and what is wrong with it."""
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    if path.suffix == ".bin":
        return _floats(raw, path)
    layout = _ply_layout(raw, path) if path.suffix == ".ply" else _pcd_layout(raw, path)
    return _cloud(_points(raw, layout, path), layout.height)


def _floats(raw: bytes, path: Path) -> Cloud:
    width = NUSCENES_FLOATS if path.name.endswith(NUSCENES_SUFFIX) else KITTI_FLOATS
    if len(raw) % (4 * width):
        raise InputError(f"{path}: {len(raw)} bytes are no whole number of points of {width} 32-bit floats; copy the file again")
    values = np.frombuffer(raw, dtype="<f4").reshape(-1, width)
    ring = values[None, :, 4].astype(np.int64) if width == NUSCENES_FLOATS else None
    return Cloud(_without_zeros(values[None, :, :3].copy()), ring)


def _cloud(points: Array, height: int) -> Cloud:
    shape = (height, len(points) // height)
    xyz = np.stack([points[name].astype(np.float32) for name in "xyz"], axis=-1).reshape(*shape, 3)
    ring = next((name for name in RING_FIELDS if name in (points.dtype.names or ())), None)
    return Cloud(_without_zeros(xyz), None if ring is None else points[ring].astype(np.int64).reshape(shape))


def _without_zeros(points: Array) -> Array:
    points[~np.isfinite(points).all(axis=-1) | (points == 0).all(axis=-1)] = np.nan
    return points


def _points(raw: bytes, layout: _Layout, path: Path) -> Array:
    """The points as a structured array (N,)."""
    if not {"x", "y", "z"} <= set(layout.dtype.names or ()):
        raise InputError(f"{path}: the cloud has no x, y, z")
    body = raw[layout.start :]
    if layout.data == "ascii":
        return _ascii(body, layout, path)
    if layout.data == "binary_compressed":
        return _compressed(body, layout, path)
    if len(body) < layout.count * layout.dtype.itemsize:
        raise InputError(f"{path}: cut off: {len(body) // layout.dtype.itemsize} of {layout.count} points are there")
    return np.frombuffer(body, dtype=layout.dtype, count=layout.count)


def _ascii(body: bytes, layout: _Layout, path: Path) -> Array:
    rows = body.decode("ascii", "replace").splitlines()[: layout.count]
    names = layout.dtype.names or ()
    try:
        table = np.array([row.split()[: len(names)] for row in rows], dtype=np.float64).reshape(-1, len(names))
    except ValueError as error:
        raise InputError(f"{path}: a point is no row of {len(names)} numbers; copy the file again") from error
    if len(table) < layout.count:
        raise InputError(f"{path}: cut off: {len(table)} of {layout.count} points are there")
    points = np.empty(len(table), dtype=layout.dtype)
    for column, name in enumerate(names):
        points[name] = np.nan_to_num(table[:, column]) if points[name].dtype.kind != "f" else table[:, column]
    return points


def _compressed(body: bytes, layout: _Layout, path: Path) -> Array:
    """LZF, the fields one after the other."""
    from floorplan.readers.lzf import unpack_lzf

    size, whole = (int(value) for value in np.frombuffer(body[:8], dtype="<u4")) if len(body) >= 8 else (0, 0)
    if len(body) < 8 + size or whole != layout.count * layout.dtype.itemsize:
        raise InputError(f"{path}: the compressed points are cut off or of another size than the header says")
    out = np.zeros(whole, dtype=np.uint8)
    if unpack_lzf(np.frombuffer(body, dtype=np.uint8, count=size, offset=8), out) != whole:
        raise InputError(f"{path}: the compressed points are damaged")
    points, at = np.empty(layout.count, dtype=layout.dtype), 0
    for name in layout.dtype.names or ():
        kind = layout.dtype[name]
        points[name] = out[at : at + layout.count * kind.itemsize].view(kind)
        at += layout.count * kind.itemsize
    return points


def _header(raw: bytes, last: str, path: Path) -> tuple[list[list[str]], int]:
    """Words of each header line up to the one that begins with `last`, and where the data begin."""
    at, lines = 0, []
    while at < min(len(raw), HEADER_BYTES):
        end = raw.find(b"\n", at)
        if end < 0:
            break
        words = raw[at:end].decode("ascii", "replace").split()
        at = end + 1
        if words:
            lines.append(words)
        if words and words[0] == last:
            return lines, at
    raise InputError(f"{path}: no {path.suffix[1:].upper()} header that ends with '{last}'")


def _ply_layout(raw: bytes, path: Path) -> _Layout:
    lines, start = _header(raw, "end_header", path)
    data = next((words[1] for words in lines if words[0] == "format" and len(words) > 1), "")
    order = PLY_ORDERS.get(data, "<")
    if lines[0] != ["ply"] or (data != "ascii" and data not in PLY_ORDERS):
        raise InputError(f"{path}: no PLY header of a known format")
    elements = [k for k, words in enumerate(lines) if words[0] == "element"]
    if not elements or lines[elements[0]][1:2] != ["vertex"]:
        raise InputError(f"{path}: the first element of the PLY file is not its vertices; write them first")
    fields = [words for words in lines[elements[0] + 1 : (elements[1:] or [len(lines)])[0]] if words[0] == "property"]
    if any(len(words) != 3 or words[1] not in PLY_TYPES for words in fields):
        raise InputError(f"{path}: a property of the PLY vertices is no number")
    if len({words[2] for words in fields}) < len(fields):
        raise InputError(f"{path}: two properties of the PLY vertices have one name")
    dtype = np.dtype([(words[2], order + PLY_TYPES[words[1]]) for words in fields])
    return _Layout(dtype, _whole(lines[elements[0]][2:3], path), 1, data if data == "ascii" else "binary", start)


def _pcd_layout(raw: bytes, path: Path) -> _Layout:
    lines, start = _header(raw, "DATA", path)
    told = {words[0]: words[1:] for words in lines}
    names, sizes, types = told.get("FIELDS", []), told.get("SIZE", []), told.get("TYPE", [])
    counts = told.get("COUNT", ["1"] * len(names))
    if not names or not len(names) == len(sizes) == len(types) == len(counts):
        raise InputError(f"{path}: the PCD header's FIELDS, SIZE, TYPE and COUNT do not match")
    fields = zip(names, sizes, types, counts, strict=True)
    parts = [(f"{n}.{k}" if k else n, f"<{kind.lower()}{size}") for n, size, kind, count in fields for k in range(_whole([count], path))]
    try:
        dtype = np.dtype([(f"_{k}" if name == "_" else name, kind) for k, (name, kind) in enumerate(parts)])
    except (TypeError, ValueError) as error:
        raise InputError(f"{path}: the PCD header's fields cannot be read ({error})") from error
    width, height = (_whole(told.get(name, ["1"]), path) for name in ("WIDTH", "HEIGHT"))
    data = (told["DATA"] or [""])[0]
    if data not in ("ascii", "binary", "binary_compressed"):
        raise InputError(f"{path}: PCD data are '{data}', not ascii, binary or binary_compressed")
    return _Layout(dtype, width * height, max(height, 1), data, start)


def _whole(words: list[str], path: Path) -> int:
    if not words or not words[0].isdigit():
        raise InputError(f"{path}: the header has no whole number where one belongs")
    return int(words[0])
