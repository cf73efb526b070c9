"""The command line: the only part that prints, reads the environment or exits. Nothing heavy is imported here."""

import gc
import sys

from floorplan.cli.app import app
from floorplan.cli.interrupts import INTERRUPTED, was_interrupted
from floorplan.errors import FloorplanError

OBJECTS_BETWEEN_COLLECTIONS = 200_000  # Python looks for garbage in cycles every 700: a third of a second of a start that leaves none


def main() -> None:
    """Run the command line; a `FloorplanError` becomes its message and exit code, anything else is a bug with its traceback."""
    gc.set_threshold(OBJECTS_BETWEEN_COLLECTIONS)
    try:
        app()
    except FloorplanError as error:
        print(f"floorplan: {error}", file=sys.stderr)  # noqa: T201
        sys.exit(error.exit_code)
    except SystemError as error:
        if not was_interrupted(error):
            raise
        sys.exit(INTERRUPTED)


__all__ = ["app", "main"]
