"""A few shapes as SVG text, on a white card: legible on white and on dark pages alike."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from xml.sax.saxutils import escape

Point = Sequence[float]

INK, FAINT, CARD = "#222222", "#8a8a8a", "#ffffff"
BLUE, ORANGE, SKY, VERMILION = "#0072B2", "#E69F00", "#56B4E9", "#D55E00"
"""The palette of the other plots, safe for colour-blind readers."""


class Drawing:
    """Shapes in pixels, x to the right and y down."""

    def __init__(self, width: int, height: int, title: str) -> None:
        self._size, self._title = (width, height), title
        self._shapes: list[str] = []

    def text(self, at: Point, words: str, color: str = INK, **look: object) -> None:
        """Write words; `look` are attributes: anchor, size, weight."""
        anchor, size = look.get("anchor", "start"), look.get("size", 13)
        self._add(
            f'<text x="{at[0]:.1f}" y="{at[1]:.1f}" fill="{color}" font-size="{size}" '
            f'font-weight="{look.get("weight", "normal")}" text-anchor="{anchor}">'
            f"{escape(words)}</text>"
        )

    def line(
        self, points: Iterable[Point], color: str = INK, width: float = 1.0, dash: str = ""
    ) -> None:
        """Draw a line through points."""
        self._add(
            f'<polyline points="{_listed(points)}" fill="none" stroke="{color}" '
            f'stroke-width="{width:g}"{_dash(dash)}/>'
        )

    def area(
        self,
        points: Iterable[Point],
        fill: str = "none",
        color: str = INK,
        width: float = 1.0,
        dash: str = "",
        opacity: float = 1.0,
    ) -> None:
        """Draw a polygon; `opacity` is its filling's."""
        self._add(
            f'<polygon points="{_listed(points)}" fill="{fill}" fill-opacity="{opacity:g}" '
            f'stroke="{color}" stroke-width="{width:g}"{_dash(dash)}/>'
        )

    def dot(self, at: Point, radius: float, fill: str, color: str = INK) -> None:
        """Draw a dot."""
        self._add(
            f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius:g}" fill="{fill}" '
            f'stroke="{color}" stroke-width="1.4"/>'
        )

    def done(self) -> str:
        """Return the file's text."""
        width, height = self._size
        return "\n".join(
            [
                f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" '
                f'width="{width}" height="{height}" '
                f'font-family="DejaVu Sans, Verdana, sans-serif" role="img">',
                f"<title>{escape(self._title)}</title>",
                f'<rect width="{width}" height="{height}" rx="8" fill="{CARD}"/>',
                *self._shapes,
                "</svg>\n",
            ]
        )

    def _add(self, shape: str) -> None:
        self._shapes.append(shape)


def _listed(points: Iterable[Point]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _dash(dash: str) -> str:
    return f' stroke-dasharray="{dash}"' if dash else ""
