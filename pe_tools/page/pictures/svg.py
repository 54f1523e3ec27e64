"""SVG drawings inside the page: a canvas, and pictures with labels."""

import base64
import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from pe_core.base.arrays import Floats

from ...templating import Markup
from ..markup import escaped

PictureBox = tuple[float, float, float, float]  # Left, top, width and height
LINE_HEIGHT = 17.0
LETTER_WIDTH = 10.0
"""Height of a line of text, and mean width of a letter, in a picture 640 wide."""
LABEL_RISE = 7.0  # Distance of a label above its point
FOOT_HEIGHT = 26.0  # Space below a picture for the labels of its lower edge
TextLabel = tuple[float, float, str]  # Position (right, down) in a picture [px], and text


@dataclass(eq=False)
class Canvas:
    """An SVG drawing; `width` and `height` are its view box, `alt` is its text alternative. A
    drawing of the class ``drawn`` is as wide as what it is in, others are as wide as their box."""

    width: float
    height: float
    alt: str
    css: str = "drawn"
    parts: list[str] = field(default_factory=list)

    def add(self, name: str, **attributes: object) -> None:
        """Add an element; underscores in attribute names become hyphens, `css` its class."""
        self.parts.append(f"<{name}{_attributes(attributes)}/>")

    def text(self, x: float, y: float, words: str, **attributes: object) -> None:
        """Add a text."""
        place = _attributes({"x": x, "y": y, **attributes})
        self.parts.append(f"<text{place}>{escaped(words)}</text>")

    def picture(self, png: bytes, box: PictureBox, css: str = "shot") -> None:
        """Add a PNG, stretched to a box; class ``cells`` keeps the edges of pixels sharp."""
        source = f"data:image/png;base64,{base64.b64encode(png).decode()}"
        size = dict(zip(("x", "y", "width", "height"), map(float, box), strict=True))
        self.add("image", href=source, preserveAspectRatio="none", css=css, **size)

    def path(self, lines: Iterable[Floats], closed: bool = True, **attributes: object) -> None:
        """Add lines (N, 2) as one path."""
        self.add("path", d="".join(path_of(line, closed) for line in lines), **attributes)

    def svg(self) -> Markup:
        """Return the drawing as markup."""
        head: dict[str, object] = {"css": self.css}
        head["viewBox"] = f"0 0 {_svg_number(self.width)} {_svg_number(self.height)}"
        head |= {} if self.css == "drawn" else {"width": self.width}
        head |= {"role": "img", "aria_label": self.alt}
        return Markup(f"<svg{_attributes(head)}>{''.join(self.parts)}</svg>")


def path_of(line: Floats, closed: bool) -> str:
    """Return the path of a line (N, 2), without points on the straight way to the next."""
    points = np.round(np.asarray(line, float), 1)
    if closed and len(points) > 1 and (points[0] == points[-1]).all():
        points = points[:-1]
    if len(points) > 2:
        before = points - np.roll(points, 1, axis=0)
        after = np.roll(points, -1, axis=0) - points
        turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        ends = np.zeros(len(points), bool)
        ends[[0, -1]] = not closed
        points = points[(np.abs(turn) > 1e-6) | ends]
    if not len(points):
        return ""
    steps = " ".join(f"{_svg_number(x)} {_svg_number(y)}" for x, y in points.tolist())
    return f"M{steps}{'z' if closed else ''}"


def _attributes(values: dict[str, object]) -> str:
    named = {name.rstrip("_").replace("_", "-"): value for name, value in values.items()}
    named = {"class" if name == "css" else name: value for name, value in named.items()}
    texts = {k: _svg_number(v) if isinstance(v, float) else escaped(v) for k, v in named.items()}
    return "".join(f' {name}="{text}"' for name, text in texts.items())


def _svg_number(value: float) -> str:
    text = f"{value:.1f}"
    return text[:-2] if text.endswith(".0") else text


@dataclass(frozen=True, slots=True)
class LabelledPicture:
    """A PNG of a size [px] with labels. `labels` stand above points of the picture, `bottom_labels`
    below its lower edge at a distance from the left, `left_labels` at its left edge at a distance
    from the top."""

    png: bytes
    width: int
    height: int
    labels: tuple[TextLabel, ...]
    bottom_labels: tuple[tuple[float, str], ...] = ()
    left_labels: tuple[tuple[float, str], ...] = ()

    def svg(self, alt: str) -> Markup:
        """Return the picture with its labels; those of low pictures stand in a space above."""
        is_low = bool(self.bottom_labels)
        width = float(self.width)
        on_edge = tuple((x, 0.0, text) for x, _, text in self.labels)
        ups = stacked(on_edge, -math.inf) if is_low else stacked(self.labels)
        head = LINE_HEIGHT - min(ups) if is_low and ups else 0.0
        foot = FOOT_HEIGHT if is_low else 0.0
        canvas = Canvas(width, head + self.height + foot, alt)
        box = 0.0, head, width, float(self.height)
        canvas.picture(self.png, box, "cells" if is_low else "shot")
        for (x, y, text), up in zip(self.labels, ups, strict=True):
            if up < y - LINE_HEIGHT:
                line = f"M{x:.1f} {head + y - 2:.1f}V{head + up + 3:.1f}"
                color = "#8c959f" if is_low else "#fff"
                canvas.add("path", d=line, stroke=color, stroke_opacity="0.7")
            half = LETTER_WIDTH * len(text) / 2.0
            across = min(max(x, half), width - half)
            css = "mark" if is_low else "mark dark"
            canvas.text(across, head + up, text, text_anchor="middle", css=css)
        for x, text in self.bottom_labels:
            anchor = "start" if x < 1.0 else "end" if x > width - 1.0 else "middle"
            canvas.text(x, head + self.height + 18.0, text, text_anchor=anchor, css="mark")
        for y, text in self.left_labels:
            down = head + min(max(y, 15.0), self.height - 5.0)
            canvas.text(5.0, down, text, css="mark dark")
        return canvas.svg()


def stacked(labels: tuple[TextLabel, ...], highest: float = LINE_HEIGHT) -> list[float]:
    """Return the vertical position of each label: above its point, and clear of other labels."""
    placed: list[tuple[float, float, float]] = []
    for x, y, text in labels:
        half = LETTER_WIDTH * len(text) / 2.0
        up = max(y - LABEL_RISE, highest)
        while any(abs(x - a) < half + b and abs(up - c) < LINE_HEIGHT for a, b, c in placed):
            up -= LINE_HEIGHT
        placed.append((x, half, up))
    return [up for _, _, up in placed]
