"""PDF and PNG of a sheet through matplotlib, whose own fonts are the same on every machine; the only module that imports it."""

import io
from dataclasses import dataclass
from itertools import count, groupby
from typing import TYPE_CHECKING, Any

from floorplan.writers.layers import Layer, LayerStyle
from floorplan.writers.scene import Fill, Item, Label, Scene, Stroke
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
    order = count()  # later ones lie on top
    for (layer, filled), run in groupby(scene.items, key=lambda item: (item.layer, isinstance(item, Fill))):
        items = list(run)
        if filled:
            for item in items:
                if isinstance(item, Fill):
                    _fill(axes, item, next(order))
            continue
        for pen, strokes in _by_pen(items, layers[layer]).items():
            _strokes(axes, strokes, pen, layers[layer].ink, next(order))
        for item in items:
            if isinstance(item, Label):
                _label(axes, item, layers[layer].ink, next(order))


@dataclass(frozen=True)
class _Pen:
    """What a stroke is drawn with: width, and lengths of dashes and gaps."""

    width_mm: float
    dash_mm: tuple[float, ...]


def _by_pen(items: list[Item], style: LayerStyle) -> dict[_Pen, list[Stroke]]:
    """The strokes of one layer by their pen: of one ink, they may be drawn as one path, which takes a third of the time."""
    found: dict[_Pen, list[Stroke]] = {}
    for item in items:
        if isinstance(item, Stroke):
            pen = _Pen(style.pen_mm if item.pen_mm is None else item.pen_mm, tuple(item.dash_mm))
            found.setdefault(pen, []).append(item)
    return found


def _strokes(axes: "Axes", strokes: list[Stroke], pen: _Pen, ink: str, order: int) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    paths = [Path((*one.points, one.points[0]) if one.closed else one.points, closed=one.closed) for one in strokes]
    axes.add_patch(
        PathPatch(
            Path.make_compound_path(*paths),
            fill=False,
            edgecolor=ink,
            linewidth=pen.width_mm * POINTS_PER_MM,
            linestyle=(0, tuple(length / pen.width_mm for length in pen.dash_mm)) if pen.dash_mm else "-",
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
