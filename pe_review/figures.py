"""Figures as people read them: units, a real minus sign, no more digits than mean something."""

from __future__ import annotations

from collections.abc import Sequence

from .engine import advice

MINUS = "\N{MINUS SIGN}"
NARROW = "\N{NARROW NO-BREAK SPACE}"
ARROW = "\N{RIGHTWARDS ARROW}"
joined = advice.joined


def number(value: float, digits: int = 2) -> str:
    """Return a number with so many digits; never "-0.00"."""
    text = f"{value:.{digits}f}"
    return text.lstrip("-") if not text.strip("-0.") else text.replace("-", MINUS)


def change(value: float, digits: int = 2) -> str:
    """Return a number with its sign."""
    text = number(value, digits)
    return text if text[0] == MINUS or not text.strip("0.") else f"+{text}"


def percent(share: float) -> str:
    """Return a share, 0 to 1, as "81.4 %", in one piece."""
    return f"{number(100.0 * share, 1)}{NARROW}%"


def percent_points(share: float) -> str:
    """Return a difference of shares as "+3.2 points"."""
    return f"{change(100.0 * share, 1)} points"


def triple(values: Sequence[float], digits: int = 2) -> str:
    """Return three numbers as "0.50, 0.00, 1.80"."""
    return ", ".join(number(v, digits) for v in values)


def count(value: int, noun: str) -> str:
    """Return "1 sensor", "15,904 triangles"."""
    return f"{value:,} {noun}{'' if value == 1 else 's'}"


def up_first(text: str) -> str:
    """Return a text that begins a sentence."""
    return text[:1].upper() + text[1:]
