"""Where the data files a user may copy and change lie: sheets, report page, settings."""

from pathlib import Path

from floorplan.errors import InputError


def templates_dir() -> Path:
    """The folder `templates`: inside an installed package, beside the package in a checkout."""
    package = Path(__file__).resolve().parent
    for folder in (package / "templates", package.parent / "templates"):
        if folder.is_dir():
            return folder
    raise InputError(f"the templates are missing ({package / 'templates'}); install floorplan again")
