"""How the job tells what it is doing, without knowing who listens. The default listener is silent."""

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Protocol, TypeVar

if TYPE_CHECKING:
    from floorplan.model.scan import Problem

T = TypeVar("T")
Progress = Callable[[int, int], None]  # called with (done, total)


def no_progress(done: int, total: int) -> None:
    """A progress callback that does nothing."""


Steps = Callable[[str], Progress]  # progress of one named step of a longer job


def no_steps(title: str) -> Progress:
    """Steps that nobody watches."""
    return no_progress


def in_one_step(progress: Progress, work: Callable[[], T]) -> T:
    """What `work` gives, shown as a single step: begun, then done."""
    progress(0, 1)
    try:
        return work()
    finally:
        progress(1, 1)


class Reporter(Protocol):
    """Messages and progress of one job."""

    def message(self, text: str) -> None:
        """One line about what was done."""
        ...

    def detail(self, text: str) -> None:
        """One line that only a curious user wants."""
        ...

    def progress(self, title: str) -> Progress:
        """A callback for one long task; the bar ends when done equals total."""
        ...


def tell_problems(reporter: Reporter, problems: "Iterable[Problem]") -> None:
    """One line per kind of bad data: what, how often, where first, what to do."""
    for p in problems:
        reporter.message(f"note: {problem_words(p)}")


def problem_words(problem: "Problem") -> str:
    """The kind of bad data as a sentence; the whole recording's has neither place nor count."""
    times = f" ({problem.count}x, first: {problem.where})" if problem.where else f" ({problem.count}x)" if problem.count > 1 else ""
    return f"{problem.code}: {problem.message}{times}; {problem.advice}"


class SilentReporter:
    """Tells nobody."""

    def message(self, text: str) -> None:
        """Nothing."""

    def detail(self, text: str) -> None:
        """Nothing."""

    def progress(self, title: str) -> Progress:
        """A callback that does nothing."""
        return no_progress
