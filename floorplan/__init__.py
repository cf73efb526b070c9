"""Offline floor plans that surveyors trust, from recorded depth and odometry."""

__version__ = "0.1.0"
