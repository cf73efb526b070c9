"""Corrections by hand: reading edits.toml, applying it to the merge and to the plan, and telling what does not apply."""
