"""One typed section per stage. Every field has a default, a unit in its name and a reason in its comment.

A stage is given its own section only. Loading from TOML and `--set` is in `config_file.py`: an unknown key is an error, a
`Literal` lists the words a setting can be, and no setting whose name ends with a unit can be negative.
"""

from dataclasses import dataclass, field
from typing import Literal


@dataclass(frozen=True)
class ReadConfig:
    """What a recording does not say about itself. 0 or empty: as the recording says, or found out."""

    fx: float = 0.0  # pixels of the depth image, centres at whole numbers
    fy: float = 0.0  # 0: as fx
    cx: float = 0.0
    cy: float = 0.0
    depth_scale: float = 0.0  # depth units per metre: 1000 for millimetres, 5000 in the TUM sets
    range_scale: float = 1.0  # what the sensor reads for a true metre: readings are divided by it, after the offset is taken off
    range_offset_mm: float = 0.0  # what every reading is too long by (too short: negative)
    world_up: str = ""  # axis of the odometry's world that points up: "+z", "-y", ...
    range_topic: str = ""  # of a ROS bag: depth images, sweeps or clouds; empty: the only one there is
    pose_topic: str = ""  # of a ROS bag: Odometry, PoseStamped, ...; empty: the only one there is, else tf
    imu_topic: str = ""  # of a ROS bag: the accelerometer that tells a camera's gravity; empty: the one named most like the images


@dataclass(frozen=True)
class IngestConfig:
    """Stage `1-ingest`."""

    # "refine" matches each sweep with those before, "rgbd" makes poses from depth and colour; auto: lasers, and recordings without poses
    odometry: Literal["auto", "recorded", "refine", "rgbd"] = "auto"
    close_loops: bool = True  # of matched sweeps: places seen again are joined before walls are looked for
    keyframe_distance_m: float = 0.10  # a frame that moved less ...
    keyframe_angle_deg: float = 4.0  # ... and turned less than this since the last keyframe shows nothing new
    keyframe_gap_s: float = 1.0  # one keyframe at least this often
    laser_keyframe_distance_m: float = 0.10  # sweeps between are placed by matching; many at one place carry no news ...
    laser_keyframe_angle_deg: float = 3.0  # ... but a turn brings new beams into view: a little more densely than a camera's
    trim: str = ""  # "12s:340s" of the recording are used, "12s:" to its end; empty: all of it
    max_unreadable_share: float = 0.10  # of the depth images; with more the recording itself is suspect
    returns_to_start: bool | None = None  # None: as the recording says


@dataclass(frozen=True)
class SeveralConfig:
    """How several scans of one floor are laid on each other."""

    start: str = "match"  # by their walls, wherever; "common": all began at one place; else a file of point pairs, as by --start
    start_sha256: str = ""  # of that file, filled in by the program


@dataclass(frozen=True)
class CompassConfig:
    """Manhattan yaw, in `2-segments`."""

    method: Literal["moments", "entropy"] = "moments"  # or "entropy", the published search


@dataclass(frozen=True)
class SegmentsConfig:
    """Labelling, components and plane fits, in `2-segments`."""

    method: Literal["normals", "vote"] = "normals"  # or "vote", the published k x k vote
    pixel_stride: int = 2  # every second row and column: costs 1 % of the coverage, no accuracy; a laser keeps all its beams
    max_columns: int = 180  # of the grid: half a degree per column; finer images are thinned more
    window_m: float = 0.20  # neighbourhood of normals and vote: as wide as the narrowest wall piece worth drawing
    normal_sigma_deg: float = 2.5  # far away, where noise would make normals worse than this, the neighbourhood grows
    tolerance_deg: float = 5.0  # a surface further off every axis than this is outside the Manhattan model
    min_extent_m: float = 0.25  # a segment's longer side at least (of lasers: min_sweep_extent_m)
    min_sweep_extent_m: float = 0.35  # shorter runs of beams fit any axis
    min_area_m2: float = 0.04  # smaller patches are furniture and clutter
    evidence_points: int = 1300  # points kept per frame for openings and views, evenly over the image
    max_evidence_points: int = 5_000_000  # of a recording: what plans of any length fit into memory with; longer ones keep fewer per frame


@dataclass(frozen=True)
class TrackingConfig:
    """Segments of consecutive frames to initial planes, in `3-least-squares`."""

    gate_m: float = 0.05  # 3-8 cm measured equally good; 15 cm loses precision
    tight_gate_m: float = 0.02  # plus three sigmas of the segment: well seen planes a few cm apart stay apart
    gap_m: float = 0.30  # along the plane: a new sighting touches the last one, or nearly
    missed_frames: int = 3  # keyframes a plane may be out of sight
    missed_s: float = 2.0  # ... or seconds, as long as hardly a step was walked: turning on the spot
    missed_walk_m: float = 0.3
    min_single_area_m2: float = 0.2  # a patch seen in one keyframe only must be this large to count


@dataclass(frozen=True)
class LeastSquaresConfig:
    """Stage `3-least-squares`."""

    method: Literal["robust", "plain"] = "robust"  # "plain": unweighted rows, as published; VIO with lasting scale errors wants weights


@dataclass(frozen=True)
class MergeConfig:
    """Stage `4-merge`. `radius_m`, `eps` and `mu_m` are the paper's; `evidence` takes its gates from the covariance."""

    method: Literal["paper", "evidence"] = "evidence"
    engine: Literal["reduced", "cvxpy"] = "reduced"  # of `paper`; "cvxpy" is the verbatim reference, slow and wrong at building scale
    radius_m: float = 1.0
    eps: float = 0.02
    mu_m: float = 0.30
    moves: bool = True  # of `evidence`: once all is merged, tracks and parts of planes move where the evidence of the whole grows
    second_candidate: bool = True  # after `moves`: weighted L1 and chi-square where the search was in doubt; evidence chooses per axis


@dataclass(frozen=True)
class ResolveConfig:
    """Stage `5-resolve`."""

    covariance: bool = True  # planes x planes: a gigabyte at ten thousand planes, so it can be left out


@dataclass(frozen=True)
class CorrectionsConfig:
    """What a person adds to the scan, in `5-resolve`."""

    laser_file: str = ""  # distances measured by hand, as by --laser; empty: none
    laser_sha256: str = ""  # of that file, filled in by the program: a changed file is a changed setting


@dataclass(frozen=True)
class EditsConfig:
    """Corrections by hand, in `4-merge` and `6-plan`."""

    edits_file: str = ""  # as by --edits; empty: none
    edits_sha256: str = ""  # of that file, filled in by the program


@dataclass(frozen=True)
class PlanConfig:
    """Stage `6-plan`."""

    max_bridged_gap_m: float = 0.30  # narrower than any door; closed only where no ray passed
    cell_along_m: float = 0.05  # grain of the ray counts along a wall; edges are placed more finely
    cell_up_m: float = 0.10  # and up it
    wall_band_low_m: float = 1.2  # above tables, desks and sills ...
    wall_band_high_m: float = 1.95  # ... and below door lintels: here a wall is hit and an opening is seen through
    min_wall_length_m: float = 0.20  # a jamb, a recess; shorter pieces are not told from clutter
    min_free_length_m: float = 0.60  # of a wall off the axes; its direction is not known well from less
    min_frames: int = 3  # what stood in fewer keyframes may have been passing by
    min_thickness_m: float = 0.05  # thinnest partition
    max_thickness_m: float = 0.60  # thickest wall; farther apart two faces are a shaft or a room
    max_door_width_m: float = 1.3  # wider openings join two rooms into one
    min_door_width_m: float = 0.6  # narrower ones cannot be walked through
    max_opening_width_m: float = 1.6  # wider free runs are no opening in a wall but the lack of one
    max_window_width_m: float = 4.0  # a ribbon of windows wider than this is read window by window or not at all
    min_room_area_m2: float = 1.0  # smaller closed spaces are shafts and cupboards


@dataclass(frozen=True)
class DrawingConfig:
    """Writers: units, scale, sheet."""

    units: Literal["m", "mm", "ft"] = "m"
    scale: str = ""  # "1:50"; empty: chosen to fit the sheet
    sheet: str = "A3"  # A4 .. A0, ANSI A .. ANSI E
    dxf_version: Literal["R2000", "R2004", "R2007", "R2010", "R2013", "R2018"] = "R2010"
    layers: Literal["ncs", "iso13567"] = "ncs"  # layer names: US NCS, or ISO 13567
    profile: Literal["", "cafm"] = ""  # "cafm": R2000, metres, no hatches, one kind of entity per layer, for strict importers
    template: str = ""  # a DXF with the office's own title block; empty: the built-in one


@dataclass(frozen=True)
class SiteConfig:
    """Where the plan lies on the site grid, for every export."""

    control_file: str = ""  # points known in both systems, as by --control; empty: none
    control_sha256: str = ""  # of that file, filled in by the program
    north_deg: float | None = None  # grid north, degrees counter-clockwise from the plan's +y, as by --north


@dataclass(frozen=True)
class ProjectConfig:
    """What the title block says."""

    name: str = ""
    address: str = ""
    floor: str = ""
    surveyor: str = ""
    client: str = ""
    north_deg: float | None = None  # where north lies, degrees counter-clockwise from the plan's +y; None: not known, no arrow
    map_crs: str = ""  # what IFC calls the site grid of --control: "EPSG:25832"; empty: "site grid"


@dataclass(frozen=True)
class Config:
    """The effective configuration: one section per stage."""

    read: ReadConfig = field(default_factory=ReadConfig)
    ingest: IngestConfig = field(default_factory=IngestConfig)
    several: SeveralConfig = field(default_factory=SeveralConfig)
    compass: CompassConfig = field(default_factory=CompassConfig)
    segments: SegmentsConfig = field(default_factory=SegmentsConfig)
    tracking: TrackingConfig = field(default_factory=TrackingConfig)
    least_squares: LeastSquaresConfig = field(default_factory=LeastSquaresConfig)
    merge: MergeConfig = field(default_factory=MergeConfig)
    resolve: ResolveConfig = field(default_factory=ResolveConfig)
    corrections: CorrectionsConfig = field(default_factory=CorrectionsConfig)
    edits: EditsConfig = field(default_factory=EditsConfig)
    plan: PlanConfig = field(default_factory=PlanConfig)
    drawing: DrawingConfig = field(default_factory=DrawingConfig)
    site: SiteConfig = field(default_factory=SiteConfig)
    project: ProjectConfig = field(default_factory=ProjectConfig)
