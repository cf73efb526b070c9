"""What the user sees: data on stdout, messages and progress on stderr, colours only where they are welcome."""

import json
import os
import sys
import time
from collections.abc import Iterable
from typing import Any, TextIO

import typer

from floorplan.reporting import Progress, no_progress

READER_GONE = 141  # as a shell tells SIGPIPE
LINE_EVERY_S = 10.0  # without a terminal, a long task says this often how far it is


def echo(text: str = "", stream: TextIO | None = None) -> None:
    """One line of data on stdout (or `stream`); ends the program quietly where its reader has gone, as `head` does."""
    try:
        typer.echo(text, file=stream)
    except BrokenPipeError:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, (stream or sys.stdout).fileno())  # what is left in the buffer goes there at the end
        raise typer.Exit(READER_GONE) from None


def counted(count: int, name: str) -> str:
    """`1 row`, `2 rows`."""
    return f"{count} {name}{'' if count == 1 else 's'}"


def whole_mm(length_m: float) -> str:
    """`+3`, `-12`, and `0` without a sign."""
    rounded = round(1000 * length_m)
    return f"{rounded:+d}" if rounded else "0"


def echo_json(tree: Any) -> None:
    """A JSON tree on stdout."""
    echo(json.dumps(tree, indent=2, ensure_ascii=False))


def echo_table(rows: Iterable[tuple[str, ...]]) -> None:
    """Rows of text in columns, on stdout."""
    lines = [tuple(row) for row in rows]
    widths = [max(len(line[i]) for line in lines if len(line) > i) for i in range(max(map(len, lines), default=0))]
    for line in lines:
        echo("  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=False)).rstrip())


class ConsoleReporter:
    """Messages and progress bars on stderr; plain lines where stderr is no terminal."""

    def __init__(self, quiet: bool = False, verbose: bool = False, stream: TextIO | None = None) -> None:
        """`quiet` keeps to errors; `verbose` adds the details."""
        self.quiet, self.verbose, self.stream = quiet, verbose, stream or sys.stderr

    def message(self, text: str) -> None:
        """One line, unless quiet."""
        if not self.quiet:
            echo(text, self.stream)

    def detail(self, text: str) -> None:
        """One line, when verbose."""
        if self.verbose and not self.quiet:
            echo(f"  {text}", self.stream)

    def progress(self, title: str) -> Progress:
        """A bar on a terminal, a line now and then elsewhere, nothing when quiet."""
        if self.quiet:
            return no_progress
        return _Bar(title).update if self.stream.isatty() else _Lines(title, self).update


class _Lines:
    """Says how far a task is every few seconds."""

    def __init__(self, title: str, reporter: ConsoleReporter) -> None:
        self.title, self.reporter, self.last_s = title, reporter, time.monotonic()

    def update(self, done: int, total: int) -> None:
        if time.monotonic() - self.last_s >= LINE_EVERY_S:
            self.last_s = time.monotonic()
            self.reporter.message(f"  {self.title}: {done} of {total}")


class _Bar:
    """A rich progress bar that appears with the first report and goes with the last."""

    def __init__(self, title: str) -> None:
        self.title = title
        self.bar: Any = None

    def update(self, done: int, total: int) -> None:
        bar = self.bar or self._started()
        bar.update(bar.task_ids[0], completed=done, total=total)
        if done >= total:
            bar.stop()
            self.bar = None

    def _started(self) -> Any:
        from rich.console import Console
        from rich.progress import Progress as RichProgress

        self.bar = bar = RichProgress(*RichProgress.get_default_columns(), console=Console(stderr=True), transient=True)
        bar.add_task(self.title, total=None)
        bar.start()
        return bar
