"""Pictures with words on them: distances above heads, angles along the edges."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..engine import graphics
from ..markup import Markup
from .svg import Canvas, hexadecimal

LINE, LETTER = 17.0, 10.0
"""Height of a line of words, and about the width of a letter, in a picture 640 wide."""
ABOVE = 7.0
EDGE = 26.0
"""Room below for words along the edge."""
KEY_WIDE = 190.0

MarkWord = tuple[float, float, str]


@dataclass(frozen=True, slots=True)
class MarkedPicture:
    """A picture, PNG, of a size [px], with words.

    `marks` are texts above places (right, down) in it, `below` texts under its lower edge by their
    places along it, `beside` texts at its left edge by their places down it.
    """

    png: bytes
    width: int
    height: int
    marks: tuple[MarkWord, ...]
    below: tuple[tuple[float, str], ...] = ()
    beside: tuple[tuple[float, str], ...] = ()

    def svg(self, alt: str) -> Markup:
        """Return it as a drawing."""
        canvas = Canvas(float(self.width), self.head + self.height + self.foot, alt)
        box = 0.0, self.head, float(self.width), float(self.height)
        canvas.picture(self.png, box, "cells" if self.below else "shot")
        self._mark(canvas)
        for x, words in self.below:
            anchor = "start" if x < 1.0 else "end" if x > self.width - 1.0 else "middle"
            down = self.head + self.height + 18.0
            canvas.text(x, down, words, text_anchor=anchor, css="mark")
        for y, words in self.beside:
            down = self.head + min(max(y, 15.0), self.height - 5.0)
            canvas.text(5.0, down, words, css="mark dark")
        return canvas.svg()

    @property
    def head(self) -> float:
        """Room above for marks, of a picture that is low."""
        ups = lifted(self._on_edge, -math.inf) if self.below else []
        return LINE - min(ups) if ups else 0.0

    @property
    def _on_edge(self) -> tuple[MarkWord, ...]:
        return tuple((x, 0.0, words) for x, _, words in self.marks)

    @property
    def foot(self) -> float:
        """Room below for words along the edge."""
        return EDGE if self.below else 0.0

    def _mark(self, canvas: Canvas) -> None:
        """Write what is above places, in the picture or in the room above it."""
        head, css = self.head, "mark" if self.head else "mark dark"
        ups = lifted(self._on_edge, -math.inf) if head else lifted(self.marks)
        for (x, y, words), up in zip(self.marks, ups, strict=True):
            if up < y - LINE:
                line = f"M{x:.1f} {head + y - 2:.1f}V{head + up + 3:.1f}"
                color = "#8c959f" if head else "#fff"
                canvas.add("path", d=line, stroke=color, stroke_opacity="0.7")
            half = LETTER * len(words) / 2.0
            across = min(max(x, half), self.width - half)
            canvas.text(across, head + up, words, text_anchor="middle", css=css)


def lifted(marks: tuple[MarkWord, ...], highest: float = LINE) -> list[float]:
    """Return how far down each text stands: above its place, higher where another is there."""
    placed: list[tuple[float, float, float]] = []
    for x, y, words in marks:
        half, up = LETTER * len(words) / 2.0, max(y - ABOVE, highest)
        while any(abs(x - a) < half + b and abs(up - c) < LINE for a, b, c in placed):
            up -= LINE
        placed.append((x, half, up))
    return [up for _, _, up in placed]


def range_key(far_m: float) -> Markup:
    """Return what the colours of a LiDAR's ranges mean, near to far."""
    canvas = Canvas(
        640.0, 34.0, f"Key: near is bright, {far_m:g} m is dark; orange is the own body"
    )
    scale = graphics.RANGES
    wide = KEY_WIDE / 24
    for k in range(24):
        fill = hexadecimal(graphics.on_scale(k / 23.0, scale).tolist())
        canvas.add("rect", x=k * wide, y=0.0, width=wide + 0.4, height=10.0, fill=fill)
    canvas.text(0.0, 27.0, "0.5 m and nearer", css="mark")
    canvas.text(KEY_WIDE, 27.0, f"{far_m:g} m", text_anchor="end", css="mark")
    at = KEY_WIDE + 30.0
    for color, words in (
        (graphics.BODY_NEAR, "own body"),
        (graphics.NO_ECHO, "nothing comes back"),
    ):
        canvas.add("rect", x=at, y=0.0, width=14.0, height=14.0, fill=hexadecimal(color))
        canvas.text(at + 20.0, 12.0, words, css="mark")
        at += 44.0 + LETTER * len(words)
    return canvas.svg()
