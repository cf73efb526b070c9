"""What can go wrong for a reason the user can mend: one base class, a few children, each with its exit code.

A message says what is wrong, where (file, line, frame, stamp) and what to do. Anything that is not a
`FloorplanError` is a bug: it keeps its traceback and the program exits with 1.
"""


class FloorplanError(Exception):
    """Base of every error a user can act on; `exit_code` is what the command line returns."""

    exit_code = 1


class UsageError(FloorplanError):
    """The command, an option or a setting is wrong (exit code 2)."""

    exit_code = 2


class ConfigError(UsageError):
    """A configuration file or `--set` names an unknown key or a value of the wrong type or range."""


class InputError(FloorplanError):
    """The recording, or another input file, cannot be used (exit code 3)."""

    exit_code = 3


class WorkFolderError(InputError):
    """The work folder is locked, belongs to another scan, or lacks a finished stage."""


class NoSolutionError(FloorplanError):
    """The optimisation has no solution, or the solver's answer failed our own checks (exit code 4)."""

    exit_code = 4


class CheckFailedError(FloorplanError):
    """A comparison against measured distances exceeded its tolerance (exit code 5)."""

    exit_code = 5
