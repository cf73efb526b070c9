"""PDF and PNG of a sheet through matplotlib, whose own fonts are the same on every machine; the only module that imports it."""

import io
from typing import TYPE_CHECKING, Any

from floorplan.writers.layers import Layer, LayerStyle
from floorplan.writers.scene import Fill, Label, Scene, Stroke
from floorplan.writers.text_size import CAP_HEIGHT_EM

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MM_PER_INCH = 25.4
POINTS_PER_MM = 72 / MM_PER_INCH
PNG_DPI = 200  # an A3 sheet is 3307 pixels wide; 1.8 mm lettering is 14 pixels high
PNG_LONGEST_PIXELS = 6000  # larger sheets get fewer dots per inch
SHADES = 8  # steps from an ink to white at the edges of its lines
MOST_COLOURS = 256  # of a PNG palette
TRUE_TYPE = 42  # fonts embedded as such: text stays text


def pdf_bytes(scene: Scene, layers: dict[Layer, LayerStyle], title: str) -> bytes:
    """One page of the sheet's size, vector, with searchable text."""
    import matplotlib

    with matplotlib.rc_context({"pdf.fonttype": TRUE_TYPE}):
        metadata = {"Title": title, "Creator": None, "Producer": None, "CreationDate": None}
        return _saved(scene, layers, {"format": "pdf", "metadata": metadata})


def png_bytes(scene: Scene, layers: dict[Layer, LayerStyle]) -> bytes:
    dpi = min(PNG_DPI, PNG_LONGEST_PIXELS / (max(scene.width_mm, scene.height_mm) / MM_PER_INCH))
    content = _saved(scene, layers, {"format": "png", "dpi": dpi, "metadata": {"Software": None}})
    fills = {item.colour for item in scene.items if isinstance(item, Fill)}
    return _few_colours(content, dpi, sorted(fills), sorted({"#000000", *(layers[item.layer].ink for item in scene.items)}))


def _few_colours(png: bytes, dpi: float, fills: list[str], inks: list[str]) -> bytes:
    """The same picture with a palette of the drawing's own: its fills, and its inks in steps towards white; a third of the size."""
    from PIL import Image

    lines = [(ink, step) for step in range(SHADES) for ink in inks]
    shades = [
        c + (255 - c) * step // SHADES for colour, step in [("#ffffff", 0), *((fill, 0) for fill in fills), *lines] for c in _rgb(colour)
    ]
    palette = Image.new("P", (1, 1))
    palette.putpalette(shades[: 3 * MOST_COLOURS])
    with Image.open(io.BytesIO(png)) as picture:
        stream = io.BytesIO()
        picture.convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE).save(stream, "PNG", dpi=(dpi, dpi))
    return stream.getvalue()


def _rgb(colour: str) -> tuple[int, ...]:
    return tuple(int(colour[k : k + 2], 16) for k in (1, 3, 5))


def _saved(scene: Scene, layers: dict[Layer, LayerStyle], options: dict[str, Any]) -> bytes:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(scene.width_mm / MM_PER_INCH, scene.height_mm / MM_PER_INCH), facecolor="white")
    _draw(figure, scene, layers)
    stream = io.BytesIO()
    figure.savefig(stream, **options)
    return stream.getvalue()


def _draw(figure: "Figure", scene: Scene, layers: dict[Layer, LayerStyle]) -> None:
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0, scene.width_mm)
    axes.set_ylim(0, scene.height_mm)
    for order, item in enumerate(scene.items):
        if isinstance(item, Label):
            _label(axes, item, layers[item.layer].ink, order)
        elif isinstance(item, Fill):
            _fill(axes, item, order)
        else:
            _stroke(axes, item, layers[item.layer], order)


def _stroke(axes: "Axes", stroke: Stroke, style: LayerStyle, order: int) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    points = (*stroke.points, stroke.points[0]) if stroke.closed else stroke.points
    pen = style.pen_mm if stroke.pen_mm is None else stroke.pen_mm
    dash = (0, tuple(length / pen for length in stroke.dash_mm)) if stroke.dash_mm else "-"
    axes.add_patch(
        PathPatch(
            Path(points, closed=stroke.closed),
            fill=False,
            edgecolor=style.ink,
            linewidth=pen * POINTS_PER_MM,
            linestyle=dash,
            capstyle="butt",
            joinstyle="miter",
            zorder=order,
        )
    )


def _fill(axes: "Axes", fill: Fill, order: int) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    rings = [Path((*ring, ring[0]), closed=True) for ring in fill.rings]
    axes.add_patch(PathPatch(Path.make_compound_path(*rings), facecolor=fill.colour, linewidth=0, zorder=order))


def _label(axes: "Axes", label: Label, ink: str, order: int) -> None:
    axes.text(
        *label.at,
        label.text,
        fontsize=label.height_mm / CAP_HEIGHT_EM * POINTS_PER_MM,
        fontfamily="DejaVu Sans",
        fontweight="bold" if label.bold else "normal",
        color=ink,
        horizontalalignment={"start": "left", "middle": "center", "end": "right"}[label.align.value],
        verticalalignment="baseline",
        rotation=label.rotation_deg,
        rotation_mode="anchor",
        parse_math=False,
        zorder=order,
    )
