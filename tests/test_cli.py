"""The command line's manners: exit codes, messages, data on stdout, nothing heavy for --help."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from floorplan import __version__
from floorplan.build import Job
from floorplan.cli import app
from floorplan.cli.console import counted, whole_mm
from floorplan.errors import ConfigError, FloorplanError, InputError, UsageError, WorkFolderError
from floorplan.work.folder import Owner, claim

RUNNER = CliRunner()
HEAVY = ("numpy", "numba", "scipy", "cvxpy", "open3d", "shapely", "ezdxf", "matplotlib", "rich.progress")


def run_program(*arguments: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-c", "from floorplan.cli import main; main()", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


def error_of(*arguments: str) -> FloorplanError:
    result = RUNNER.invoke(app, list(arguments))
    assert isinstance(result.exception, FloorplanError), result.output
    return result.exception


def test_help_and_version_import_nothing_heavy() -> None:
    code = (
        "import sys\nfrom typer.testing import CliRunner\nfrom floorplan.cli import app\n"
        "for a in (['--help'], ['--version'], ['build', '--help']):\n    assert CliRunner().invoke(app, a).exit_code == 0\n"
        f"print([m for m in {HEAVY!r} if m in sys.modules])"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == "[]"


def test_the_package_runs_as_a_module() -> None:
    command = [sys.executable, "-m", "floorplan", "--version"]
    assert subprocess.run(command, capture_output=True, text=True, check=True).stdout == f"floorplan {__version__}\n"


def test_version_is_the_packages() -> None:
    assert RUNNER.invoke(app, ["--version"]).output.strip() == f"floorplan {__version__}"


def test_a_users_mistake_ends_with_one_line_on_stderr_and_its_code(tmp_path: Path) -> None:
    result = run_program("build", str(tmp_path / "nowhere"))
    assert (result.returncode, result.stdout) == (3, "")
    assert result.stderr.startswith("floorplan: ")
    assert "no such file or folder" in result.stderr
    assert "Traceback" not in result.stderr


def test_wrong_usage_is_2() -> None:
    assert RUNNER.invoke(app, ["build"]).exit_code == 2
    assert RUNNER.invoke(app, ["paint"]).exit_code == 2
    assert RUNNER.invoke(app, ["build", "scan", "--paint"]).exit_code == 2


@pytest.mark.parametrize(
    ("arguments", "kind", "words"),
    [
        (["build", "{dir}", "--set", "merge.radus_m=1"], ConfigError, "radius_m"),
        (["build", "{dir}", "--units", "furlongs"], ConfigError, "m, mm, ft"),
        (["build", "{dir}", "--profile", "loose"], ConfigError, "cafm"),
        (["build", "{dir}", "--layers", "own"], ConfigError, "iso13567"),
        (["build", "{dir}", "--dxf-version", "R12"], ConfigError, "R2018"),
        (["build", "{dir}", "--from", "paint"], UsageError, "segments"),
        (["build", "{dir}", "--dxf", "{dir}/no/plan.dxf"], UsageError, "no folder"),
        (["build", "{dir}", "--until", "merge", "--png", "{dir}/plan.png"], UsageError, "stops before the plan"),
        (["build", "{dir}", "--png", "{dir}/plan.jpg"], UsageError, "PNG, not .jpg"),
        (["build", "{dir}", "--json", "{dir}/plan.dxf"], UsageError, "JSON, not .dxf"),
        (["build", "{dir}", "--format", "tum", "--topic", "depth=/d"], UsageError, "no ROS bag"),
        (["info", "{dir}", "--format", "stray", "--topic", "depth=/d"], UsageError, "no ROS bag"),
        (["build", "{dir}", "--north", "400"], UsageError, "-360 to 360"),
        (["build", "{dir}", "--format", "guess"], UsageError, "guess"),
        (["build", "{dir}", "--config", "{dir}/no.toml"], ConfigError, "no such configuration"),
        (["build", "{dir}", "--laser", "{dir}/laser.csv", "--set", "merge.method=paper"], UsageError, "merge.method = evidence"),
        (["build", "{dir}"], InputError, "not recognised"),
        (["info", "{dir}"], InputError, "not recognised"),
        (["status", "{dir}"], WorkFolderError, "not a work folder"),
        (["export", "{dir}", "--dxf", "{dir}/plan.dxf"], WorkFolderError, "not a work folder"),
        (["export", "{dir}"], UsageError, "--dxf"),
        (["export", "{dir}", "--graph", "{dir}/graph.npz"], WorkFolderError, "not a work folder"),
        (["merges", "{dir}"], WorkFolderError, "not a work folder"),
    ],
)
def test_each_mistake_has_its_kind_and_says_what_to_do(tmp_path: Path, arguments: list[str], kind: type, words: str) -> None:
    (tmp_path / "laser.csv").write_text("id,measured_m\nD1,5.0\n")
    error = error_of(*(argument.replace("{dir}", str(tmp_path)) for argument in arguments))
    assert type(error) is kind
    assert words in str(error)
    assert [file.name for file in tmp_path.iterdir()] == ["laser.csv"]


def test_config_prints_what_config_reads() -> None:
    text = RUNNER.invoke(app, ["config", "--set", "merge.radius_m=0.5"]).stdout
    assert tomllib.loads(text)["merge"]["radius_m"] == 0.5
    assert json.loads(RUNNER.invoke(app, ["config", "--json"]).stdout)["merge"]["method"] in ("paper", "evidence")


def test_doctor_finds_this_machine_good() -> None:
    result = RUNNER.invoke(app, ["doctor", "--json"])
    assert result.exit_code == 0
    assert {check["name"] for check in json.loads(result.stdout)} >= {"python", "open3d", "cvxpy", "free disk"}


def test_a_build_cannot_stop_before_it_begins(tmp_path: Path) -> None:
    (tmp_path / "scan").mkdir()
    error = error_of("build", str(tmp_path / "scan"), "--from", "merge", "--until", "ingest")
    assert isinstance(error, UsageError)
    assert "--from merge comes after --until ingest" in str(error)


def test_an_interrupted_build_says_what_is_kept_and_how_to_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(job: Job, reporter: object) -> None:
        (job.work / "1-ingest").mkdir(parents=True)
        (job.work / "2-segments.partial").mkdir()
        raise KeyboardInterrupt

    monkeypatch.setattr("floorplan.build.build", interrupted)
    (tmp_path / "scan").mkdir()
    result = RUNNER.invoke(app, ["build", str(tmp_path / "scan")])
    assert result.exit_code == 130
    assert "keeps 1-ingest, part of 2-segments. Give the same command again" in result.stderr


def test_ctrl_c_that_met_compiled_code_is_130_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def compiled(job: Job, reporter: object) -> None:
        raise SystemError("CPUDispatcher returned a result with an exception set") from KeyboardInterrupt()

    def broken(job: Job, reporter: object) -> None:
        raise SystemError("truly broken") from ValueError()

    (tmp_path / "scan").mkdir()
    monkeypatch.setattr("floorplan.build.build", compiled)
    assert RUNNER.invoke(app, ["build", str(tmp_path / "scan")]).exit_code == 130
    monkeypatch.setattr("floorplan.build.build", broken)
    assert isinstance(RUNNER.invoke(app, ["build", str(tmp_path / "scan")]).exception, SystemError)


def test_a_reader_that_has_gone_ends_the_program_quietly() -> None:
    code = "from floorplan.cli.console import echo\nfrom floorplan.cli import app\nimport typer\n"
    code += "from floorplan.cli import main\napp.command('much')(lambda: [echo('x' * 100) for _ in range(10000)])\nmain()"
    program = subprocess.Popen([sys.executable, "-c", code, "much"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert program.stdout is not None
    assert program.stderr is not None
    program.stdout.readline()
    program.stdout.close()
    assert program.wait(60) == 141
    assert program.stderr.read() == b""
    program.stderr.close()


@pytest.mark.parametrize("place", ["file", "file/below", "/proc/floorplan"])
def test_a_work_folder_that_cannot_be_made_is_told_in_one_line(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="give another place"):
        claim(tmp_path / place, Owner("scan", "tum", "0"))


def test_counts_and_millimetres_read_as_people_write_them() -> None:
    assert [counted(n, "gap") for n in (0, 1, 2)] == ["0 gaps", "1 gap", "2 gaps"]
    assert [whole_mm(x) for x in (0.0031, -0.012, -0.0002, 0.0)] == ["+3", "-12", "0", "0"]
