"""`floorplan info`."""

import shlex
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from floorplan.cli import options as o
from floorplan.cli.console import ConsoleReporter, echo, echo_json, echo_table
from floorplan.reporting import problem_words

if TYPE_CHECKING:
    from floorplan.inspection import Inspection
    from floorplan.readers import Choice


def info(
    scan: o.Scan,
    config: o.ConfigFile = None,
    settings: o.Settings = None,
    format: o.Format = None,
    topics: o.Topics = None,
    trim: o.Trim = None,
    as_json: o.AsJson = False,
    quiet: o.Quiet = False,
) -> None:
    """What is in a recording, and what 'build' would complain about; of a folder of recordings, which they are."""
    effective = o.effective_config(config, [*(settings or []), *o.topic_settings(topics), *o.trim_settings(trim)])
    o.check_scan(scan)
    o.check_topics(scan, format, topics)
    from floorplan.inspection import inspect_scan
    from floorplan.readers import choices_in, open_scan
    from floorplan.trim import trimmed

    if format is None and (choices := choices_in(scan)):
        _print_choices(scan, choices, as_json)
        return
    source = trimmed(open_scan(scan, format, effective.read), effective.ingest.trim)
    facts = inspect_scan(source, effective.ingest, ConsoleReporter(quiet).progress)
    if as_json:
        echo_json(asdict(facts))
    else:
        _print_facts(facts)


def _print_choices(scan: Path, choices: "tuple[Choice, ...]", as_json: bool) -> None:
    """What a folder of recordings holds, and how to go on."""
    if as_json:
        echo_json({"recordings": [{"path": str(choice.path), "format": choice.format} for choice in choices]})
        return
    echo(f"{len(choices)} recordings in {scan}:" if len(choices) > 1 else f"one recording in {scan}:")
    echo_table((str(choice.path), choice.format) for choice in choices)
    first = " ".join(shlex.quote(str(choice.path)) for choice in choices[:2])
    echo(f"look at one: floorplan info {shlex.quote(str(choices[0].path))}")
    if len(choices) > 1:
        echo(f"several scans of one floor as one plan: floorplan build {first} --dxf plan.dxf")


def _print_facts(facts: "Inspection") -> None:
    wander = "" if facts.gravity_wander_deg is None else f", wanders {facts.gravity_wander_deg:.1f} degrees"
    rows = [
        ("format", facts.format),
        ("sensor", f"{facts.sensor}, {facts.width} x {facts.height}"),
        ("frames", f"{facts.frames} at {facts.rate_hz:.1f} Hz, of which {facts.keyframes} would be looked at"),
        ("time", f"{facts.duration_s:.1f} s, stamps {facts.first_stamp_s:.3f} to {facts.last_stamp_s:.3f}"),
        ("gaps", f"{facts.gaps}, the longest {facts.longest_gap_s:.1f} s" if facts.gaps else "none"),
        ("path", f"{facts.path_length_m:.1f} m"),
        ("walk", f"up to {facts.speed_m_s:.1f} m/s, turns up to {facts.turn_deg_s:.0f} degrees a second"),
        ("gravity", facts.gravity_source + wander),
    ]
    if (lens := facts.intrinsics) is not None:
        rows.append(("intrinsics", f"fx {lens.fx:.2f}, fy {lens.fy:.2f}, cx {lens.cx:.2f}, cy {lens.cy:.2f} pixels of the depth image"))
    if facts.median_range_m is not None and facts.filled_share is not None:
        rows.append(("ranges", f"median {facts.median_range_m:.2f} m, {100 * facts.filled_share:.0f} % of pixels filled"))
    rows.append(("build", f"about {facts.build_s:.0f} s on one core ({facts.build_basis})"))
    echo_table(rows)
    for problem in facts.problems:
        grade = "stops the build" if problem.fatal else "note"
        echo(f"{grade}: {problem_words(problem)}")
    for one in facts.advice:
        echo(f"better: {one}")
    if not facts.problems and not facts.advice:
        echo("nothing to complain about")
