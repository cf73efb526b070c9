"""`floorplan view`: a finished survey in three dimensions."""

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from floorplan.cli import options as o
from floorplan.cli.console import echo
from floorplan.errors import UsageError


def view(
    work: o.Work,
    screenshot: Annotated[Path | None, typer.Option("--screenshot", metavar="F.png", help="A picture; needs no screen.")] = None,
    frame: Annotated[int | None, typer.Option("--frame", metavar="N", help="What the camera saw in frame N, labelled.")] = None,
    above: Annotated[bool, typer.Option("--above", help="With --screenshot: from straight above, without perspective.")] = False,
    ceilings: Annotated[bool, typer.Option("--ceilings", help="Show ceilings too; they hide the rooms from above.")] = False,
) -> None:
    """3D look at points by axis, planes, and the path before (grey) and after (black)."""
    if frame is not None:
        if screenshot is None:
            raise UsageError("--frame needs --screenshot F.png, the picture to write")
        from floorplan.frame_export import export_frame

        row = export_frame(work, o.effective_config(work / "config.toml", None), frame, screenshot)
        echo(f"{screenshot} (frame {row})")
        return
    if screenshot is None and not _has_screen():
        raise UsageError("there is no screen to open a window on; --screenshot F.png makes a picture instead")
    from floorplan.view import show
    from floorplan.write_view import read_scene, write_screenshot

    scene = read_scene(work, ceilings)
    if screenshot is None:
        show(scene, f"floorplan {work}")
        return
    write_screenshot(scene, screenshot, above)
    echo(str(screenshot))


def _has_screen() -> bool:
    return sys.platform in ("darwin", "win32") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
