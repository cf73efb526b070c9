"""Width of a line of text without asking a font file, so that placement is the same on every machine.

Advance widths of DejaVu Sans, thousandths of an em, characters 32 to 126: the widest of the sans fonts a sheet is shown in.
"""

CAP_HEIGHT_EM = 0.729  # height of capitals of DejaVu Sans; text heights of drawings are capital heights
LINE_SPACING = 1.6  # baseline to baseline, in capital heights
_OTHER_EM = 700  # accented letters and signs beyond ASCII
_BOLD_FACTOR = 1.12
_WIDTHS_EM = (
    *(318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337),
    *(636, 636, 636, 636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531),
    *(1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863, 748, 787),
    *(603, 787, 695, 635, 611, 732, 684, 989, 685, 611, 685, 390, 337, 390, 838, 500),
    *(500, 613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579, 278, 974, 634, 612),
    *(635, 635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838),
)
_FIRST = 32


def text_width(text: str, height: float, bold: bool = False) -> float:
    """Width of `text` with capitals of `height`, in the unit of `height`."""
    total = 0
    for character in text:
        index = ord(character) - _FIRST
        total += _WIDTHS_EM[index] if 0 <= index < len(_WIDTHS_EM) else _OTHER_EM
    return total / 1000 / CAP_HEIGHT_EM * height * (_BOLD_FACTOR if bold else 1.0)


def wrapped(text: str, width: float, height: float) -> list[str]:
    """`text` broken at blanks into lines no wider than `width`; a single longer word stays whole."""
    lines: list[str] = []
    for word in text.split():
        if lines and text_width(f"{lines[-1]} {word}", height) <= width:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    return lines


def shortened(text: str, width: float, height: float) -> str:
    """`text`, or as much of it as fits into `width` with an ellipsis."""
    if text_width(text, height) <= width:
        return text
    while text and text_width(text + "...", height) > width:
        text = text[:-1]
    return text.rstrip() + "..."
