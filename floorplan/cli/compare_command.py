"""`floorplan compare`: two surveys of one floor."""

from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from floorplan.cli import options as o
from floorplan.cli.console import ConsoleReporter, echo, echo_json, echo_table, whole_mm

if TYPE_CHECKING:
    from floorplan.compare import Comparison
    from floorplan.compare.changes import WallPiece
    from floorplan.compare.differences import Repeatability
    from floorplan.compare.openings import OpeningChange

FirstWork = Annotated[Path, typer.Argument(metavar="WORK_A", help="The work folder of the first survey.", show_default=False)]
SecondWork = Annotated[Path, typer.Argument(metavar="WORK_B", help="The work folder of the second survey.", show_default=False)]
LISTED = 40  # rows of each kind on a terminal; --json has all


def compare(
    first: FirstWork,
    second: SecondWork,
    dxf: o.Dxf = None,
    svg: o.Svg = None,
    png: o.Png = None,
    as_json: o.AsJson = False,
    scale: o.Scale = None,
    sheet: o.Sheet = None,
    quiet: o.Quiet = False,
) -> None:
    """Two surveys of one floor: every wall, opening and distance that moved by more than both can be off."""
    from floorplan.compare import compare_surveys, survey_of
    from floorplan.drawings import Drawing, check_drawings
    from floorplan.export import read_results

    asked = {kind: path for kind, path in (("dxf", dxf), ("svg", svg), ("png", png)) if path is not None}
    check_drawings(tuple(Drawing(kind, path) for kind, path in asked.items()))
    surveys = [survey_of(str(work), read_results(work)) for work in (first, second)]
    comparison = compare_surveys(*surveys)
    effective = o.effective_config(None, None, scale=scale, sheet=sheet)
    if asked:
        from floorplan.writers.comparison import write_comparison

        for kind, path in asked.items():
            write_comparison(path, kind, surveys[0].plan, comparison, effective.drawing)
            ConsoleReporter(quiet).message(f"wrote {path}")
    if as_json:
        echo_json(comparison_tree(comparison))
    else:
        print_comparison(comparison)


def comparison_tree(comparison: "Comparison") -> dict[str, Any]:
    """The comparison as JSON values, but for the second plan itself."""
    tree = {f.name: getattr(comparison, f.name) for f in fields(comparison) if f.name not in ("second_plan", "alignment")}
    values = {name: _plain(value) for name, value in tree.items()}
    laid = comparison.alignment
    alignment = {"quarters": laid.quarters, "shift_m": laid.shift_m.tolist(), "ambiguous": laid.ambiguous}
    alignment |= {"matched_m": laid.matched_m, "share": laid.share, "warnings": alignment_warnings(comparison)}
    return {**values, "alignment": alignment, "changed": comparison.changed}


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [asdict(one) for one in value]
    return value if value is None or isinstance(value, str | float) else asdict(value)


def print_comparison(comparison: "Comparison") -> None:
    """What changed, kind by kind, then how well the two agree."""
    laid = comparison.alignment
    where = f"x {laid.shift_m[0]:+.3f} m, y {laid.shift_m[1]:+.3f} m"
    echo(f"second laid on first: {laid.quarters} quarter turns, {where}; {laid.matched_m:.1f} m of wall on wall")
    if laid.ambiguous:
        echo("note: the floor looks nearly alike from another side; make sure that this is the right way round")
    for warning in alignment_warnings(comparison):
        typer.echo(f"warning: {warning}", err=True)
    _print_walls(comparison)
    _print_openings(comparison)
    moved = [d for d in comparison.distances if d.moved]
    _listed(
        f"{len(moved)} of {len(comparison.distances)} distances changed by more than both can be off",
        [(d.first, d.room, f"{d.first_m:.3f}", f"{d.second_m:.3f} m", _mm(d.difference_m, d.interval_m)) for d in moved],
    )
    echo()
    _print_agreement("walls", comparison.wall_repeatability)
    _print_agreement("distances", comparison.distance_repeatability)
    if comparison.unseen_m:
        echo(f"{comparison.unseen_m:.1f} m of wall were in view of one survey only: nothing is said about them")


def _print_walls(comparison: "Comparison") -> None:
    moved = [wall for wall in comparison.walls if wall.moved]
    rows = [
        (", ".join(w.first), ", ".join(w.second), "xy"[w.axis], _mm(w.moved_m, w.interval_m), f"{w.length_m:.1f} m long") for w in moved
    ]
    _listed(f"{len(moved)} of {len(comparison.walls)} wall faces moved by more than both can be off (5 % do by chance)", rows)
    for name, pieces in (("gone", comparison.gone), ("new", comparison.new)):
        _listed(f"{len(pieces)} pieces of wall are {name}", [_piece_cells(piece) for piece in pieces])


def _piece_cells(piece: "WallPiece") -> tuple[str, ...]:
    (x1, y1), (x2, y2) = piece.start, piece.end
    return piece.wall, f"{piece.length_m:.1f} m", f"({x1:.2f}, {y1:.2f}) to ({x2:.2f}, {y2:.2f})"


def _print_openings(comparison: "Comparison") -> None:
    moved = [opening for opening in comparison.openings if opening.moved]
    _listed(
        f"{len(moved)} of {len(comparison.openings)} openings changed",
        [
            (
                o.first or "-",
                o.second or "-",
                opening_words(o),
                f"{whole_mm(o.moved_m)} +-{1000 * o.moved_interval_m:.0f} mm along",
                f"{whole_mm(o.width_difference_m)} +-{1000 * o.width_interval_m:.0f} mm wide",
            )
            for o in moved
        ],
    )


def alignment_warnings(comparison: "Comparison") -> tuple[str, ...]:
    """Where little speaks for the alignment, and so for all that rests on it."""
    laid, found = comparison.alignment, []
    if not laid.sure:
        found.append(
            f"only {100 * laid.share:.0f} % of the smaller survey's wall lies on the other's: are these of one floor? "
            "If not, all numbers below are chance"
        )
    if comparison.unseen_m > laid.matched_m:
        found.append(
            f"{comparison.unseen_m:.1f} m of wall were in view of one survey only, more than the {laid.matched_m:.1f} m that both have: "
            "the agreement below is that of a small part"
        )
    return tuple(found)


def opening_words(opening: "OpeningChange") -> str:
    """`moved`, or what became of what: `window, now door`."""
    if opening.first_kind and opening.second_kind and opening.first_kind != opening.second_kind:
        return f"{opening.state.value}: {opening.first_kind}, now {opening.second_kind}"
    return opening.state.value


def _listed(title: str, rows: Sequence[tuple[str, ...]]) -> None:
    echo(title + (":" if rows else ""))
    echo_table(("  " + row[0], *row[1:]) for row in rows[:LISTED])
    if len(rows) > LISTED:
        echo(f"  and {len(rows) - LISTED} more: see --json")


def _mm(moved_m: float, interval_m: float) -> str:
    return f"{whole_mm(moved_m)} +-{1000 * interval_m:.0f} mm"


def _print_agreement(name: str, agreed: "Repeatability | None") -> None:
    if agreed is not None:
        echo(
            f"repeatability, {agreed.count} {name}: median {1000 * agreed.median_m:.1f} mm, 95 % within {1000 * agreed.p95_m:.1f} mm; "
            f"{100 * agreed.share_within:.0f} % inside their combined 95 % interval"
        )
