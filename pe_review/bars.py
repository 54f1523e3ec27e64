"""Bars with their figures: in HTML, so that they are copied, read aloud and printed as text."""

from __future__ import annotations

from .engine import metric
from .figures import number, percent
from .markup import Markup, escaped


def bar(text: str, share: float, was: float | None = None, css: str = "") -> Markup:
    """Return a figure above a bar of 0 to 1, with a tick where it was before."""
    tick = "" if was is None else f'<u style="left:{_width(was)}"></u>'
    whose = f' class="{escaped(css)}"' if css else ""
    return Markup(
        f"<span{whose}>{escaped(text)}"
        f'<span class="bar" aria-hidden="true"><i style="width:{_width(share)}"></i>{tick}</span>'
        "</span>"
    )


def coverage_bar(share: float, was: float | None = None) -> Markup:
    """Return a coverage with its bar."""
    return bar(percent(share), share, was)


def entropy_bar(nats: float, was: float | None = None) -> Markup:
    """Return an entropy with its bar: empty at the best there is, full where nothing is seen."""
    before = None if was is None else towards_blind(was)
    return bar(number(nats), towards_blind(nats), before)


def towards_blind(nats: float) -> float:
    """Where an entropy lies between the best (0) and that of what nobody sees (1)."""
    return (nats - metric.H_BEST) / (metric.H_BLIND - metric.H_BEST)


def _width(share: float) -> str:
    return f"{100.0 * min(max(share, 0.0), 1.0):.1f}%"
