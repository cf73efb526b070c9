"""The configuration: what is accepted, what is refused and with which words."""

import dataclasses
import re
from pathlib import Path

import pytest

from floorplan.config import Config
from floorplan.config_file import config_to_toml, load_config
from floorplan.errors import ConfigError


def test_without_anything_the_defaults_hold() -> None:
    assert load_config() == Config()


def test_a_setting_beats_the_file_and_the_file_beats_the_default(tmp_path: Path) -> None:
    path = tmp_path / "floorplan.toml"
    path.write_text("[merge]\nradius_m = 2\neps = 0.05\n")
    config = load_config(path, ["merge.radius_m=0.5"])
    assert config.merge.radius_m == 0.5
    assert config.merge.eps == 0.05
    assert config.merge.mu_m == Config().merge.mu_m


def test_what_is_written_as_toml_reads_back_as_the_same_configuration(tmp_path: Path) -> None:
    config = load_config(None, ['project.name=A "quoted" \\ name', "ingest.returns_to_start=true", "project.floor=2", "merge.method=paper"])
    path = tmp_path / "written.toml"
    path.write_text(config_to_toml(config))
    assert load_config(path) == config
    assert config.project.name == 'A "quoted" \\ name'
    assert config.project.floor == "2"
    assert config.ingest.returns_to_start is True


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("merge.radus_m=1", "did you mean 'radius_m'"),
        ("merg.radius_m=1", "did you mean 'merge'"),
        ("plan.radius_m=1", "did you mean merge.radius_m"),
        ("merge.radius_m=wide", "must be a number"),
        ("merge.radius_m=-1", "must not be negative"),
        ("merge.radius_m=inf", "finite"),
        ("merge.method=guess", "paper, evidence"),
        ("segments.pixel_stride=1.5", "whole number"),
        ("ingest.returns_to_start=1", "true or false"),
        ("merge.radius_m", "section.key=value"),
    ],
)
def test_a_wrong_setting_is_refused_with_a_remedy(setting: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words) as caught:
        load_config(None, [setting])
    assert caught.value.exit_code == 2


@pytest.mark.parametrize("text", ["[merge", "radius_m = 1", "[merge]\nradius_m = 1\nradius_m = 2"])
def test_a_broken_file_is_refused_by_name(tmp_path: Path, text: str) -> None:
    path = tmp_path / "broken.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"broken\.toml"):
        load_config(path)


def test_every_default_is_within_its_own_rules() -> None:
    for section in dataclasses.fields(Config):
        for field in dataclasses.fields(values := getattr(Config(), section.name)):
            if (value := getattr(values, field.name)) is not None and not isinstance(value, str):
                text = str(list(value)) if isinstance(value, tuple) else str(value).lower()
                assert load_config(None, [f"{section.name}.{field.name}={text}"]) == Config()


def test_the_printed_settings_say_what_each_is_for_and_read_back_the_same(tmp_path: Path) -> None:
    text = config_to_toml(Config(), comments=True)
    assert re.search(r"^gap_m = 0\.3  # along the plane", text, re.MULTILINE)
    assert re.search(r'^odometry = "auto"  # "refine" matches', text, re.MULTILINE)  # the comment stands before it in the source
    assert "# Stage `6-plan`.\n[plan]" in text
    (tmp_path / "floorplan.toml").write_text(text, "utf-8")
    assert load_config(tmp_path / "floorplan.toml") == Config()
