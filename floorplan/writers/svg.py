"""SVG in real millimetres: one user unit is one millimetre on paper, one group per layer."""

from html import escape

from floorplan.model.plan import Point
from floorplan.writers.layers import Layer, LayerStyle
from floorplan.writers.scene import Fill, Item, Label, Scene
from floorplan.writers.text_size import CAP_HEIGHT_EM, text_width

FONT = "'DejaVu Sans', Verdana, Arial, sans-serif"


def svg_text(scene: Scene, layers: dict[Layer, LayerStyle], title: str) -> str:
    """The whole document; layers are groups with the id of their name, in drawing order of their first item."""
    width, height = f"{scene.width_mm:g}", f"{scene.height_mm:g}"
    parts = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="0 0 {width} {height}" '
        f'font-family="{FONT}" fill="none" stroke-linejoin="miter" stroke-linecap="butt">',
        f"<title>{escape(title)}</title>",
        f'<rect width="{width}" height="{height}" fill="#ffffff"/>',
    ]
    for layer, items in _by_layer(scene).items():
        style = layers[layer]
        parts.append(f'<g id="{escape(style.name)}" stroke="{style.ink}" stroke-width="{style.pen_mm:g}">')
        parts += [_element(item, scene.height_mm, style) for item in items]
        parts.append("</g>")
    return "\n".join([*parts, "</svg>", ""])


def _by_layer(scene: Scene) -> dict[Layer, list[Item]]:
    groups: dict[Layer, list[Item]] = {}
    for item in scene.items:
        groups.setdefault(item.layer, []).append(item)
    return groups


def _element(item: Item, height_mm: float, style: LayerStyle) -> str:
    if isinstance(item, Label):
        return _label(item, height_mm, style)
    if isinstance(item, Fill):
        path = " ".join(f"M{_points(ring, height_mm)}Z" for ring in item.rings)
        return f'<path d="{path}" fill="{item.colour}" fill-rule="evenodd" stroke="none"/>'
    pen = f' stroke-width="{item.pen_mm:g}"' if item.pen_mm is not None else ""
    dash = f' stroke-dasharray="{" ".join(f"{length:g}" for length in item.dash_mm)}"' if item.dash_mm else ""
    return f'<path d="M{_points(item.points, height_mm)}{"Z" if item.closed else ""}"{pen}{dash}/>'


def _points(points: tuple[Point, ...], height_mm: float) -> str:
    return " ".join(f"{x:.4f},{height_mm - y:.4f}" for x, y in points)


def _label(label: Label, height_mm: float, style: LayerStyle) -> str:
    """Text; its length is stated, so that another font cannot make it collide."""
    x, y = label.at[0], height_mm - label.at[1]
    turn = f' transform="rotate({-label.rotation_deg:g} {x:.3f} {y:.3f})"' if label.rotation_deg else ""
    weight = ' font-weight="bold"' if label.bold else ""
    anchor = f' text-anchor="{label.align.value}"' if label.align.value != "start" else ""
    length = text_width(label.text, label.height_mm, label.bold)
    return (
        f'<text x="{x:.3f}" y="{y:.3f}" font-size="{label.height_mm / CAP_HEIGHT_EM:.3f}" fill="{style.ink}" stroke="none"'
        f'{anchor}{weight}{turn} textLength="{length:.2f}" lengthAdjust="spacingAndGlyphs" xml:space="preserve">'
        f"{escape(label.text)}</text>"
    )


def write_svg(scene: Scene, layers: dict[Layer, LayerStyle], title: str) -> bytes:
    return svg_text(scene, layers, title).encode("utf-8")
