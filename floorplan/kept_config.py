"""`config.toml` in a work folder: the settings its stages and drawings were made with."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from floorplan.config import Config
from floorplan.config_file import config_to_toml, load_config
from floorplan.errors import ConfigError, FloorplanError
from floorplan.work.disk import clear_disk_errors, new_file

CONFIG_NAME = "config.toml"
NO_STAGE_READS = ("drawing", "site", "project")  # sections of the sheets alone


@contextmanager
def kept_config(work: Path, config: Config) -> Iterator[None]:
    """Keep `config` in `work` for a build; of one that is refused, the sheets' settings go back to what they were before.

    What a stage reads stays, for the stages that were finished with it; a scale that does not fit would else refuse every export.
    """
    path = work / CONFIG_NAME
    before = _config_before(path)
    _write(path, config)
    try:
        yield
    except FloorplanError:
        _write(path, replace(config, **{name: getattr(before, name) for name in NO_STAGE_READS}))
        raise


def _config_before(path: Path) -> Config:
    """What the build before kept; the defaults where there was none, and where another version wrote what this one cannot read."""
    try:
        return load_config(path) if path.is_file() else Config()
    except ConfigError:
        return Config()


def _write(path: Path, config: Config) -> None:
    with clear_disk_errors(path), new_file(path) as making:
        making.write_text(config_to_toml(config), "utf-8")
