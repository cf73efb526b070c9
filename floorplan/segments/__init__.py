"""Frames to layout segments: labelling, components, plane fits, and the rotation of every frame that they show.

`segment_chunk` looks at some keyframes and knows nothing of the others; `join` puts the chunks together, refines and
smooths the rotations with the whole recording, and computes distances anew under them.
"""

from floorplan.segments.chunk import grid_stride, segment_chunk
from floorplan.segments.chunk_evidence import without_points
from floorplan.segments.frame import compiled_before, segment_frame
from floorplan.segments.join import join
from floorplan.segments.picture import frame_picture
from floorplan.segments.values import SegmentedChunk

__all__ = ["SegmentedChunk", "compiled_before", "frame_picture", "grid_stride", "join", "segment_chunk", "segment_frame", "without_points"]
