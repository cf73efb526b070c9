"""`floorplan formats`, `config`, `doctor`: what can be read, which settings hold, whether this machine will do."""

from dataclasses import asdict
from pathlib import Path

import typer

from floorplan.cli import options as o
from floorplan.cli.console import echo, echo_json, echo_table


def formats(as_json: o.AsJson = False) -> None:
    """What can be read and written."""
    from floorplan.readers import READERS
    from floorplan.writers import WRITERS

    if as_json:
        read = [{"name": r.name, "description": r.description, "looks_for": r.looks_for} for r in READERS]
        echo_json({"read": read, "write": [{"name": w.name, "option": w.option, "description": w.description} for w in WRITERS.values()]})
        return
    echo_table([("read", reader.name, reader.description, reader.looks_for) for reader in READERS])
    echo_table([("write", writer.name, f"{writer.option}: {writer.description}") for writer in WRITERS.values()])


def config(config: o.ConfigFile = None, settings: o.Settings = None, as_json: o.AsJson = False) -> None:
    """The effective configuration as TOML: save it, change it, give it to --config."""
    from floorplan.config_file import config_to_toml

    effective = o.effective_config(config, settings)
    if as_json:
        echo_json(asdict(effective))
    else:
        echo(config_to_toml(effective, comments=True).rstrip())


def doctor(as_json: o.AsJson = False) -> None:
    """Whether this machine has what is needed."""
    from floorplan.doctor import examine

    checks = examine(Path.cwd())
    if as_json:
        echo_json([asdict(check) for check in checks])
    else:
        echo_table(("ok" if c.good else "MISSING", c.name, c.found, "" if c.good else c.advice) for c in checks)
    if not all(check.good for check in checks):
        raise typer.Exit(3)
