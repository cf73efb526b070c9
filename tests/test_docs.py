"""Every command is in the README, and every link in it leads somewhere."""

import re
from pathlib import Path

import typer

from floorplan.cli import app
from floorplan.config_file import load_config
from floorplan.errors import FloorplanError
from floorplan.templates_dir import templates_dir
from floorplan.work.stages import STAGES

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text("utf-8")


def commands() -> list[str]:
    return [command.name for command in app.registered_commands if command.name is not None]


def options_of(command: str) -> set[str]:
    parameters = typer.main.get_command(app).commands[command].params  # type: ignore[attr-defined]
    return {option for parameter in parameters for option in parameter.opts if option.startswith("--")}


def test_every_command_is_documented_and_no_other() -> None:
    assert set(re.findall(r"^\| `floorplan (\w+)", README, re.MULTILINE)) == set(commands())


def test_every_option_of_build_is_documented() -> None:
    missing = {option for option in options_of("build") if not re.search(rf"{option}\b", README)}
    assert missing <= {"--quiet", "--verbose"}


def test_the_stages_and_exit_codes_are_documented() -> None:
    assert " ".join(stage.name for stage in STAGES) in README
    children = FloorplanError.__subclasses__()
    for kind in children:
        assert re.search(rf"^\| {kind.exit_code} \|", README, re.MULTILINE)
    assert len(children) >= 4


def test_every_link_leads_somewhere() -> None:
    for target in re.findall(r"\]\(([^)#:]+)\)", README):
        assert (ROOT / target).exists(), target


def test_the_settings_template_holds() -> None:
    load_config(templates_dir() / "floorplan.toml")
