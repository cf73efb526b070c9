"""The presets: the paper's six areas by corridor scheme and path length, an office and a flat."""

from dataclasses import dataclass, replace

from floorplan.errors import UsageError


@dataclass(frozen=True)
class SensorSpec:
    """A depth camera: pixels, fields of view, ranges, and one reading's sigma `constant + quadratic * z^2`."""

    name: str
    width: int
    height: int
    fov_x_deg: float
    fov_y_deg: float
    min_range_m: float
    max_range_m: float
    noise_constant_m: float
    noise_quadratic_per_m: float


# Fields of view and range: METHOD.md. Noise: within the makers' 1 % at 4 m for the time-of-flight camera, and the
# usual quadratic of a structured light camera with a 75 mm base line.
MONSTAR = SensorSpec("pmd-monstar", 352, 287, 100.0, 85.0, 0.25, 6.0, 0.003, 0.0012)
PHONE = SensorSpec("phone-lidar", 256, 192, 70.7, 56.1, 0.2, 5.0, 0.004, 0.001)
ASTRA = SensorSpec("orbbec-astra", 640, 400, 60.0, 49.5, 0.5, 6.0, 0.002, 0.0019)


@dataclass(frozen=True)
class Preset:
    """A kind of building and how it is walked; lengths are ranges that the seed draws from.

    `lines_x`, `lines_y`: how many corridors run along y and along x (2 and 2 make a ring). `drift_m` is the
    start-to-end drift of the raw odometry that METHOD.md's table reports for this path length.
    """

    name: str
    lines_x: int
    lines_y: int
    path_m: float
    drift_m: float
    rate_hz: float
    sensor: SensorSpec = MONSTAR
    corridor_share: float = 0.55  # of the path; the rest goes into rooms
    corridor_width_m: tuple[float, float] = (1.7, 2.5)
    room_width_m: tuple[float, float] = (2.7, 6.5)
    room_depth_m: tuple[float, float] = (3.2, 5.6)
    ceiling_m: tuple[float, float] = (2.45, 2.9)
    glass: bool = False
    windows: float = 0.8  # share of the outer rooms
    image_scale: float = 1.0


PRESETS = {
    preset.name: preset
    for preset in (
        Preset("area1", 2, 2, 53.0, 0.67, 10.0),
        Preset("area2", 3, 2, 200.0, 2.36, 10.0),
        Preset("area3", 3, 3, 249.0, 2.24, 10.0, corridor_share=0.65),
        Preset("area4", 2, 2, 69.0, 0.46, 5.0),
        Preset("area5", 2, 2, 113.0, 1.32, 5.0),
        # Recorded at 30 Hz; written thinned to every fourth frame.
        Preset("area6", 2, 2, 67.0, 0.73, 7.5, ASTRA, 0.7, (2.2, 2.8), glass=True),
        Preset("office", 0, 1, 60.0, 0.36, 10.0, corridor_share=0.36),
        Preset("flat", 0, 1, 30.0, 0.15, 10.0, MONSTAR, 0.3, (1.3, 1.7), (2.4, 3.6), (2.9, 4.2)),
    )
}


def preset_named(name: str, path_scale: float = 1.0) -> Preset:
    """The preset of that name, its path and drift scaled; raises `UsageError` naming the choices."""
    if name not in PRESETS:
        raise UsageError(f"no preset '{name}'; choose one of {', '.join(PRESETS)}")
    preset = PRESETS[name]
    return replace(preset, path_m=preset.path_m * path_scale, drift_m=preset.drift_m * path_scale)
