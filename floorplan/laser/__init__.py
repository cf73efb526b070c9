"""Distances measured by hand: reading their table, finding them in a plan, comparing."""
