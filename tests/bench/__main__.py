"""`python -m tests.bench [NAME ...]`: the benchmarks, all or those named; `--list` says what each measures."""

import argparse
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "flat"


@dataclass(frozen=True)
class Benchmark:
    """One measurement: a module of this package, what it measures, its arguments when nothing else is asked for."""

    module: str
    measures: str
    arguments: tuple[str, ...] = ()


BENCHMARKS = {
    "front_end": Benchmark("tests.bench.front_end", "milliseconds per keyframe beside NumPy and Open3D, on a recording", (str(SAMPLE),)),
    "areas": Benchmark("tests.bench.areas", "the six simulated areas, published and default method", ("bench-areas",)),
    "back_end": Benchmark("tests.bench.back_end", "verbatim, reduced and evidence back end: seconds, memory, agreement"),
}
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}


def main() -> int:
    """Run the benchmarks named, each in a process of its own on one thread; the number of those that failed."""
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"{', '.join(BENCHMARKS)} (default: all)")
    parser.add_argument("--list", action="store_true", help="say what each measures")
    parser.add_argument("--scan", type=Path, help="recording for front_end (default: the bundled sample)")
    asked = parser.parse_args()
    if asked.list:
        sys.stdout.write("".join(f"{name:10} {benchmark.measures}\n" for name, benchmark in BENCHMARKS.items()))
        return 0
    unknown = sorted(set(asked.names) - set(BENCHMARKS))
    if unknown:
        parser.error(f"no benchmark called {', '.join(unknown)}; there are {', '.join(BENCHMARKS)}")
    return sum(_run(name, asked.scan) for name in asked.names or BENCHMARKS)


def _run(name: str, scan: Path | None) -> bool:
    """True when it failed."""
    benchmark = BENCHMARKS[name]
    arguments = (str(scan),) if scan and name == "front_end" else benchmark.arguments
    sys.stdout.write(f"\n# {name}: {benchmark.measures}\n")
    sys.stdout.flush()
    command = ["env", *(f"{key}={value}" for key, value in ONE_THREAD.items()), sys.executable, "-m", benchmark.module, *arguments]
    return subprocess.run(command, check=False).returncode != 0


if __name__ == "__main__":
    sys.exit(main())
