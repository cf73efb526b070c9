"""`python -m tests.bench` knows what it can run."""

import importlib.util
import subprocess
import sys

from tests.bench.__main__ import BENCHMARKS


def run(*arguments: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([sys.executable, "-m", "tests.bench", *arguments], capture_output=True, text=True, check=False, timeout=60)


def test_every_benchmark_has_a_module_and_is_listed() -> None:
    listed = run("--list").stdout
    for name, benchmark in BENCHMARKS.items():
        assert importlib.util.find_spec(benchmark.module) is not None
        assert f"{name} " in listed


def test_an_unknown_benchmark_is_wrong_usage() -> None:
    result = run("paint")
    assert result.returncode == 2
    assert all(name in result.stderr for name in BENCHMARKS)
