"""The command line: the only part that prints, reads the environment or exits. Nothing heavy is imported here."""

import sys

from floorplan.cli.app import app
from floorplan.cli.interrupts import INTERRUPTED, was_interrupted
from floorplan.errors import FloorplanError


def main() -> None:
    """Run the command line; a `FloorplanError` becomes its message and exit code, anything else is a bug with its traceback."""
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
