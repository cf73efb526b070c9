"""The layout graph as an `.npz` file without pickles: the back end's exchange format (DESIGN.md, section 2)."""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np

from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.graph import LayoutGraph
from floorplan.model.scan import RangeAccuracy

_SHAPES: dict[str, tuple[int | str, ...]] = {
    "stamp": ("N",),
    "translation": ("N-1", 3),
    "frame": ("K",),
    "track": ("K",),
    "distance": ("K",),
    "axis": ("M",),
    "facing": ("M",),
    "extent": ("M", 3, 2),
}
_MAY_BE_THERE: dict[str, tuple[int | str, ...]] = {
    "sigma": ("K",),
    "map_sigma": ("N",),
    "link": ("B",),
    "link_sigma": ("B", 3),
    "heading_sigma": (),  # rad, of the yaw that turned the odometry rows
    "range_accuracy": (2,),  # of the sensor: sigma of its scale (a part), sigma of its bias (m)
}
_WHOLE_NUMBERS = ("frame", "track", "axis", "facing", "link")
DEFAULT_LINK_SIGMA_M = 0.5  # of a rough pose that came without one: a step to the side
_MAY_BE_NAN = ("extent",)


def save_graph(graph: LayoutGraph, path: Path) -> None:
    """Write `graph` to `path`."""
    arrays: dict[str, Any] = {
        "stamp": graph.stamp_s,
        "translation": graph.translation_m,
        "frame": graph.frame,
        "track": graph.track,
        "distance": graph.distance_m,
        "axis": graph.axis,
        "facing": graph.facing,
        "extent": graph.extent_m,
    }
    if graph.sigma_m is not None:
        arrays["sigma"] = graph.sigma_m
    if graph.map_sigma_m is not None:
        arrays["map_sigma"] = graph.map_sigma_m
    if len(graph.link):
        arrays |= {"link": graph.link, "link_sigma": graph.link_sigma_m}
    if graph.heading_sigma_rad:
        arrays["heading_sigma"] = np.float64(graph.heading_sigma_rad)
    if graph.range_accuracy is not None:
        arrays["range_accuracy"] = np.array([graph.range_accuracy.scale_sigma, graph.range_accuracy.bias_sigma_m])
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)


def load_graph(path: Path) -> LayoutGraph:
    """The graph in `path`. Raises InputError that names the array, the row and what is wrong with it."""
    arrays = _read_arrays(path)
    shapes = dict(_SHAPES) | {name: shape for name, shape in _MAY_BE_THERE.items() if name in arrays}
    links = arrays.setdefault("link", np.zeros(0, dtype=np.int64))
    arrays.setdefault("link_sigma", np.full((len(np.atleast_1d(links)), 3), DEFAULT_LINK_SIGMA_M))
    named = {"N": "stamp", "K": "frame", "M": "axis", "B": "link"}
    sizes = {size: len(np.atleast_1d(arrays[name])) for size, name in named.items()}
    if sizes["N"] == 0:
        raise InputError(f"{path}: array 'stamp' is empty; a layout graph needs at least one frame")
    sizes["N-1"] = sizes["N"] - 1
    for name, shape in shapes.items():
        _check_array(path, name, arrays[name], tuple(sizes[s] if isinstance(s, str) else s for s in shape))
    graph = LayoutGraph(
        stamp_s=arrays["stamp"],
        translation_m=arrays["translation"],
        frame=arrays["frame"],
        track=arrays["track"],
        distance_m=arrays["distance"],
        axis=arrays["axis"],
        facing=arrays["facing"],
        extent_m=arrays["extent"],
        sigma_m=arrays.get("sigma"),
        map_sigma_m=arrays.get("map_sigma"),
        link=links,
        link_sigma_m=arrays["link_sigma"],
        heading_sigma_rad=float(arrays.get("heading_sigma", 0.0)),
        range_accuracy=RangeAccuracy(*arrays["range_accuracy"].tolist()) if "range_accuracy" in arrays else None,
    )
    _check_values(path, graph)
    return graph


def _read_arrays(path: Path) -> dict[str, Array]:
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (OSError, ValueError, zipfile.BadZipFile, AttributeError) as error:
        raise InputError(f"{path}: not a layout graph (a .npz file, as 'floorplan export WORK --graph F.npz' writes it)") from error
    missing = [name for name in _SHAPES if name not in arrays]
    if missing:
        raise InputError(
            f"{path}: array {', '.join(map(repr, missing))} is missing; a layout graph has {', '.join(_SHAPES)} and maybe sigma"
        )
    return arrays


def _check_array(path: Path, name: str, array: Array, shape: tuple[int, ...]) -> None:
    if array.shape != shape:
        raise InputError(f"{path}: array '{name}' has shape {array.shape}, expected {shape}")
    if array.dtype.kind not in "iuf":
        raise InputError(f"{path}: array '{name}' has type {array.dtype}, expected numbers")
    bad = ~np.isfinite(array) if name not in _MAY_BE_NAN else np.isinf(array)
    if bad.any():
        raise InputError(f"{path}: array '{name}' is not finite at row {np.argwhere(bad)[0][0]} ({int(bad.sum())} such values)")
    if name in _WHOLE_NUMBERS and (array != np.round(array)).any():
        raise InputError(f"{path}: array '{name}' must hold whole numbers; row {np.flatnonzero(array != np.round(array))[0]} does not")


def _check_values(path: Path, graph: LayoutGraph) -> None:
    frames, tracks = len(graph.stamp_s), len(graph.axis)
    _check_rows(path, "frame", (graph.frame < 0) | (graph.frame >= frames), f"out of range 0..{frames - 1}")
    _check_rows(path, "track", (graph.track < 0) | (graph.track >= tracks), f"out of range 0..{tracks - 1}")
    _check_rows(path, "axis", ~np.isin(graph.axis, (0, 1, 2)), "not 0, 1 or 2")
    _check_rows(path, "facing", ~np.isin(graph.facing, (-1, 1)), "not +1 or -1")
    _check_rows(path, "stamp", np.concatenate(([False], np.diff(graph.stamp_s) < 0)), "earlier than the one before")
    if graph.sigma_m is not None:
        _check_rows(path, "sigma", graph.sigma_m <= 0, "not positive")
    if graph.heading_sigma_rad < 0:
        raise InputError(f"{path}: array 'heading_sigma' is negative")
    _check_rows(path, "link", (graph.link < 0) | (graph.link >= frames - 1), f"out of range 0..{frames - 2}")
    _check_rows(path, "link_sigma", np.asarray((graph.link_sigma_m <= 0).any(axis=1)), "not positive")
    seen = np.bincount(graph.track, minlength=tracks)
    _check_rows(path, "track", seen == 0, "without any measurement: take the track out", of="track")


def _check_rows(path: Path, name: str, bad: Array, what: str, of: str = "row") -> None:
    if bad.any():
        raise InputError(f"{path}: array '{name}', {of} {np.flatnonzero(bad)[0]}: {what} ({int(bad.sum())} such {of}s)")
