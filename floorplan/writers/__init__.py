"""Writers: one file per format, a table."""
