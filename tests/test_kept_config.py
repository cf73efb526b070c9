"""Settings of a build that was refused do not spoil the exports after it."""

from pathlib import Path

import pytest

from floorplan.config import Config, DrawingConfig, PlanConfig, SiteConfig
from floorplan.config_file import load_config
from floorplan.errors import ConfigError
from floorplan.kept_config import CONFIG_NAME, kept_config


def asked(scale: str, label: str = "") -> Config:
    return Config(drawing=DrawingConfig(scale=scale, sheet="A1"), site=SiteConfig(north_deg=10.0 if label else None))


def test_a_finished_build_keeps_its_settings(tmp_path: Path) -> None:
    with kept_config(tmp_path, asked("1:50", "north")):
        pass
    assert load_config(tmp_path / CONFIG_NAME) == asked("1:50", "north")


def test_a_refused_first_build_leaves_the_sheets_defaults_and_what_stages_read(tmp_path: Path) -> None:
    tried = Config(drawing=DrawingConfig(scale="1:20"), plan=PlanConfig())
    with pytest.raises(ConfigError), kept_config(tmp_path, tried):
        raise ConfigError("does not fit")
    kept = load_config(tmp_path / CONFIG_NAME)
    assert kept.drawing == DrawingConfig()
    assert kept.plan == tried.plan


def test_a_refused_later_build_leaves_the_sheet_of_the_one_before(tmp_path: Path) -> None:
    with kept_config(tmp_path, asked("1:100")):
        pass
    with pytest.raises(ConfigError), kept_config(tmp_path, asked("1:20", "north")):
        raise ConfigError("does not fit")
    assert load_config(tmp_path / CONFIG_NAME) == asked("1:100")


def test_an_interrupted_build_keeps_what_it_was_asked_for(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), kept_config(tmp_path, asked("1:20")):
        raise KeyboardInterrupt
    assert load_config(tmp_path / CONFIG_NAME) == asked("1:20")
