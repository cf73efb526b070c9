"""Every command is in the README, and every link in it leads somewhere."""

import re
from pathlib import Path

import pytest
import typer

from floorplan.cli import app
from floorplan.config_file import load_config
from floorplan.errors import FloorplanError
from floorplan.readers import READERS
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


@pytest.mark.parametrize("command", [name for name in commands() if name not in ("build", "formats", "doctor")])
def test_every_option_of_the_other_commands_is_in_their_table(command: str) -> None:
    row = next(line for line in README.splitlines() if line.startswith(f"| `{command}` |"))
    own = options_of(command) - {"--quiet", "--verbose"} - (options_of("build") if command == "export" else set())
    assert {option for option in own if not re.search(rf"{option}\b", row)} == set()
    unknown = set(re.findall(r"--[a-z-]+", row)) - options_of(command) - {"--until"}
    assert unknown == set()


def test_every_format_that_is_read_is_documented() -> None:
    for reader in READERS:
        assert re.search(rf"^\| `{reader.name}` \|", README, re.MULTILINE)


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
