"""Places seen again: a laser's matched trajectory with its loops closed, whatever directions the walls have."""

from floorplan.loop_closing.close_loops import ClosedLoops, close_loops

__all__ = ["ClosedLoops", "close_loops"]
