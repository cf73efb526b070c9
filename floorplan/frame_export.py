"""The picture of one frame: its depth beside what each pixel was taken for, for users who ask why a wall is missing."""

from pathlib import Path

import numpy as np

from floorplan.config import Config
from floorplan.errors import InputError, UsageError
from floorplan.export import finished
from floorplan.model.scan import IngestedScan
from floorplan.readers import open_scan
from floorplan.readers.base import BadFrame
from floorplan.trim import trimmed
from floorplan.work.folder import read_owner
from floorplan.work.stages import INGEST
from floorplan.write_view import write_png

_ENLARGED = 4  # screen pixels per pixel of the grid: a frame is looked at in half its pixels or fewer


def export_frame(work: Path, config: Config, frame: int, path: Path) -> int:
    """Write the picture of the keyframe nearest to row `frame` of the recording as PNG; gives that keyframe's row.

    The compass surveys the recording again, so that the labels are the very ones of the stage. Raises `UsageError` for a frame
    that does not exist, `InputError` for a laser and for a frame that cannot be read, `WorkFolderError` before the first stage is finished.
    """
    owner = read_owner(work)
    if owner.scans:
        raise UsageError(f"{work} joins {len(owner.scans)} scans; --frame shows those of one: give {work / 'scan-1'}")
    scan = finished(work, INGEST, IngestedScan)
    if scan.recording.sensor.height == 1:
        raise InputError(f"{owner.scan}: a laser sweep has no depth image to show; --frame is for cameras")
    from floorplan.compass import survey
    from floorplan.segments import frame_picture, grid_stride, segment_frame

    source = trimmed(open_scan(Path(owner.scan), owner.format, config.read), config.ingest.trim)
    if not 0 <= frame < len(scan.recording):
        raise UsageError(f"--frame {frame}: the recording has the frames 0 to {len(scan.recording) - 1}")
    index = int(np.argmin(np.abs(scan.keyframe - frame)))
    row, sensor = int(scan.keyframe[index]), scan.recording.sensor
    read = next(iter(source.frames([row], grid_stride(sensor, config.segments))))
    if isinstance(read, BadFrame):
        raise InputError(f"frame {row}: {read.problem.message} ({read.problem.where}); choose another frame")
    segmented = segment_frame(read, index, survey(scan, source, config.compass), sensor, config.segments)
    picture = frame_picture(read.points, segmented).repeat(_ENLARGED, axis=0).repeat(_ENLARGED, axis=1)
    write_png(picture, path)
    return row
