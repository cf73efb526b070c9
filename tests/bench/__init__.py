"""Measurements against the truth of simulated scans; not part of the test suite."""
