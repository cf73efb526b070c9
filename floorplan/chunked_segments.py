"""Stage `2-segments` over a whole recording: a first look for the yaw, then chunks of keyframes, each kept when finished.

The front end is imported when it is needed: a build that finds the stage finished never waits for its compiler.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from typing import TypeVar

import numpy as np

from floorplan.config import Config
from floorplan.errors import InputError
from floorplan.model.checks import Array
from floorplan.model.scan import IngestedScan, SensorKind
from floorplan.model.segment import EvidencePoints, SegmentedScan
from floorplan.readers.base import Source
from floorplan.readers.kept_frames import KeptFrames
from floorplan.work.folder import WorkFolder
from floorplan.work.stages import SEGMENTS

T = TypeVar("T")
CHUNK_KEYFRAMES = 32  # fixed, so that the result never depends on the number of jobs; under a second's work is lost by a kill


def segment_in_chunks(source: Source, scan: IngestedScan, config: Config, work: WorkFolder, jobs: int) -> SegmentedScan:
    """The segments of every keyframe, chunk by chunk on `jobs` threads; chunks that `work` holds are not made again."""
    from floorplan import segments
    from floorplan.compass import CompassPrior, survey

    if not segments.compiled_before():
        work.reporter.message("first use: compiling for this machine, once: about a minute here, some seconds in later steps")
    stride = segments.grid_stride(scan.recording.sensor, config.segments)
    if scan.recording.sensor.kind is SensorKind.CAMERA:
        source = KeptFrames(source, stride)
    store, show = work.chunks(SEGMENTS), work.reporter.progress("segments")
    prior = store.get("prior", CompassPrior, lambda: survey(scan, source, config.compass, work.reporter.progress("compass"), jobs))
    parts = np.split(scan.keyframe, range(CHUNK_KEYFRAMES, len(scan.keyframe), CHUNK_KEYFRAMES))

    def make(rows: Array) -> segments.SegmentedChunk:
        return segments.segment_chunk(scan, prior, source.frames(rows.tolist(), stride), config.segments)

    def whole(number: int) -> segments.SegmentedChunk:
        return store.get(f"chunk-{number:05d}", segments.SegmentedChunk, lambda: make(parts[number]))

    def chunk(number: int) -> segments.SegmentedChunk:
        return segments.without_points(whole(number))

    def points(of: segments.SegmentedChunk) -> EvidencePoints:
        return whole(int(of.frame[0]) // CHUNK_KEYFRAMES).evidence

    done = _on_threads(jobs, chunk, len(parts), lambda count: show(min(count * CHUNK_KEYFRAMES, len(scan.keyframe)), len(scan.keyframe)))
    segmented = segments.join(scan, prior, done, points)
    _stop_when_too_many_are_bad(segmented, scan, config.ingest.max_unreadable_share)
    return segmented


def _on_threads(jobs: int, make: Callable[[int], T], count: int, done: Callable[[int], None]) -> list[T]:
    """What `make` gives for 0 to `count` - 1; `done` hears how many are. What was not begun when one fails, or at Ctrl-C, is left."""
    with ThreadPoolExecutor(jobs) as pool:
        waiting = [pool.submit(make, number) for number in range(count)]
        try:
            for number, finished in enumerate(as_completed(waiting), 1):
                finished.result()
                done(number)
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise
        return [future.result() for future in waiting]


def _stop_when_too_many_are_bad(segmented: SegmentedScan, scan: IngestedScan, max_share: float) -> None:
    """Raise `InputError` when more than `max_share` of the keyframes could not be read; ingest saw only how their files begin and end."""
    bad = sum(problem.count for problem in segmented.problems)
    if bad > max_share * len(scan.keyframe):
        first = segmented.problems[0]
        raise InputError(
            f"too-many-unreadable: {bad} of {len(scan.keyframe)} frames looked at could not be read (first: {first.where}, "
            f"{first.message}); copy the recording again, or raise ingest.max_unreadable_share to use what is left"
        )
