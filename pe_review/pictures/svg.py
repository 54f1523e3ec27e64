"""SVG from plain values, as it stands inside a page: texts take the page's type and colours."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..markup import Markup, escaped

Floats = NDArray[np.float64]
PictureBox = tuple[float, float, float, float]
"""Left, top, width and height."""


STYLE = Path(__file__).with_name("drawn.css").read_text("utf-8")
"""CSS of drawings and of the grids they stand in."""


@dataclass(eq=False)
class Canvas:
    """A drawing of a size, in its own units; `alt` says in words what it shows."""

    width: float
    height: float
    alt: str
    parts: list[str] = field(default_factory=list)

    def add(self, name: str, **attributes: object) -> None:
        """Add an element; underscores of a name stand for hyphens, a last one for none."""
        self.parts.append(f"<{name}{_attributes(attributes)}/>")

    def text(self, x: float, y: float, words: str, **attributes: object) -> None:
        """Add a text."""
        place = _attributes({"x": x, "y": y, **attributes})
        self.parts.append(f"<text{place}>{escaped(words)}</text>")

    def picture(self, png: bytes, box: PictureBox, css: str = "shot") -> None:
        """Add a picture, stretched to a box; one of class ``cells`` keeps its pixels' edges."""
        source = f"data:image/png;base64,{base64.b64encode(png).decode()}"
        size = dict(zip(("x", "y", "width", "height"), map(float, box), strict=True))
        self.add("image", href=source, preserveAspectRatio="none", css=css, **size)

    def path(self, lines: Iterable[Floats], closed: bool = True, **attributes: object) -> None:
        """Add lines (N, 2) as one path."""
        self.add("path", d="".join(path_of(line, closed) for line in lines), **attributes)

    def svg(self) -> Markup:
        """Return the drawing."""
        box = f"0 0 {_number(self.width)} {_number(self.height)}"
        head = f'<svg class="drawn" viewBox="{box}" role="img" aria-label="{escaped(self.alt)}">'
        return Markup(f"{head}{''.join(self.parts)}</svg>")


def path_of(line: Floats, closed: bool) -> str:
    """Return a line's points as a path, those that lie on the way to the next left out."""
    points = np.round(np.asarray(line, float), 1)
    if closed and len(points) > 1 and (points[0] == points[-1]).all():
        points = points[:-1]
    if len(points) > 2:
        before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
        turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
        ends = np.zeros(len(points), bool)
        ends[[0, -1]] = not closed
        points = points[(np.abs(turn) > 1e-6) | ends]
    if not len(points):
        return ""
    steps = " ".join(f"{_number(x)} {_number(y)}" for x, y in points.tolist())
    return f"M{steps}{'z' if closed else ''}"


def figure(drawing: Markup, caption: Markup | str = "") -> Markup:
    """Return a drawing with its caption (HTML)."""
    below = f"<figcaption>{caption}</figcaption>" if caption else ""
    return Markup(f"<figure>{drawing}{below}</figure>")


def grid(figures: Iterable[Markup], least_rem: float = 21.0) -> Markup:
    """Return figures beside each other, as many as have room, each so wide at least."""
    return Markup(f'<div class="maps" style="--least:{least_rem:g}rem">{"".join(figures)}</div>')


def hexadecimal(rgb: Sequence[float]) -> str:
    """Return a colour, 0 to 1, as "#0072b2"."""
    return "#" + "".join(f"{round(255.0 * min(max(float(c), 0.0), 1.0)):02x}" for c in rgb[:3])


def _attributes(values: dict[str, object]) -> str:
    named = {name.rstrip("_").replace("_", "-"): value for name, value in values.items()}
    named = {"class" if name == "css" else name: value for name, value in named.items()}
    return "".join(f' {name}="{_value(value)}"' for name, value in named.items())


def _value(value: object) -> str:
    return _number(value) if isinstance(value, float) else escaped(value)


def _number(value: float) -> str:
    text = f"{value:.1f}"
    return text[:-2] if text.endswith(".0") else text
