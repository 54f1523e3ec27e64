"""HTML from plain values, escaped: tables, figures, bars, and numbers with their units."""

from __future__ import annotations

import html
import json
from collections.abc import Iterable, Sequence
from typing import Any

from pe_core import metric

from .. import advice

ALLOWED_SPACES = "\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}"
"""Spaces that count as not printable, but occur in texts of this page."""
JSON_ESCAPES = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"}
"""Characters that could end a script or begin a comment, as JSON strings may also spell them."""


def escaped(text: object) -> str:
    """Return a text as HTML, also for attributes; characters that do not print are spelled out."""
    printable = "".join(
        c if c.isprintable() or c in ALLOWED_SPACES else ascii(c)[1:-1] for c in str(text)
    )
    return html.escape(printable.encode("utf-8", "backslashreplace").decode(), quote=True)


def css_string(text: object) -> str:
    """Return a text as a CSS string."""
    printable = "".join(c if c.isprintable() else " " for c in str(text))
    unsafe = '"\\<>&'
    inside = "".join(f"\\{ord(c):06x}" if c in unsafe else c for c in printable)
    return f'"{inside.encode("utf-8", "replace").decode()}"'


def script_json(data: Any) -> str:
    """Return plain data as JSON that is safe inside a script element."""
    text = json.dumps(data, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    for character, escape in JSON_ESCAPES.items():
        text = text.replace(character, escape)
    return text


def table(
    caption: str, heads: Sequence[str], rows: Iterable[Sequence[object]], *, css: str = ""
) -> str:
    """Return a table of plain texts; the first cell of a row is its header.

    Cells that are `Markup` are not escaped. A row of one cell is a heading of the rows below it.
    """
    top = "".join(f'<th scope="col">{_cell(head)}</th>' for head in heads)
    body = "".join(_row(row) for row in rows)
    classes = f' class="{escaped(css)}"' if css else ""
    return (
        f'<div class="scrolls" tabindex="0" role="region" aria-label="{escaped(caption)}">'
        f"<table{classes}><caption>{escaped(caption)}</caption>"
        f"<thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"
    )


class Markup(str):
    """A text that is HTML, and is not escaped again."""


def _row(row: Sequence[object]) -> str:
    first, *rest = row
    if not rest:
        return f'<tr class="head"><th scope="rowgroup" colspan="99">{_cell(first)}</th></tr>'
    cells = "".join(f"<td>{_cell(value)}</td>" for value in rest)
    return f'<tr><th scope="row">{_cell(first)}</th>{cells}</tr>'


def _cell(value: object) -> str:
    return str(value) if isinstance(value, Markup) else escaped(value)


MINUS = "\N{MINUS SIGN}"
ARROW = "\N{RIGHTWARDS ARROW}"
joined, percent = advice.joined, advice.percent


def number(value: float, digits: int = 2) -> str:
    """Return a number with that many decimals and a minus sign (U+2212); never "-0.00"."""
    text = f"{value:.{digits}f}"
    return text.lstrip("-") if not text.strip("-0.") else text.replace("-", MINUS)


def signed(value: float, digits: int = 2) -> str:
    """Return a number with its sign, plus or minus."""
    text = number(value, digits)
    return text if text[0] == MINUS or not text.strip("0.") else f"+{text}"


def percent_points(share: float) -> str:
    """Return a difference of shares as "+3.2 points"."""
    return f"{signed(100.0 * share, 1)} points"


def triple(values: Sequence[float], digits: int = 2) -> str:
    """Return three numbers as "0.50, 0.00, 1.80"."""
    return ", ".join(number(v, digits) for v in values)


def capitalized(text: str) -> str:
    """Return a text with its first letter in upper case."""
    return text[:1].upper() + text[1:]


def bar(text: str, share: float, was: float | None = None, css: str = "") -> Markup:
    """Return a text above a bar of length `share`, 0 to 1; a tick marks the value before."""
    tick = "" if was is None else f'<u style="left:{_css_width(was)}"></u>'
    attribute = f' class="{escaped(css)}"' if css else ""
    return Markup(
        f"<span{attribute}>{escaped(text)}"
        f'<span class="bar" aria-hidden="true"><i style="width:{_css_width(share)}"></i>{tick}'
        "</span></span>"
    )


def coverage_bar(share: float, was: float | None = None) -> Markup:
    """Return a coverage with its bar."""
    return bar(percent(share, 1), share, was)


def entropy_bar(nats: float, was: float | None = None) -> Markup:
    """Return an entropy [nats] with its bar: empty is the best value, full means unseen."""
    before = None if was is None else entropy_share(was)
    return bar(number(nats), entropy_share(nats), before)


def entropy_share(nats: float) -> float:
    """Return where an entropy lies between the best value (0) and that of unseen voxels (1)."""
    return (nats - metric.H_BEST) / (metric.H_BLIND - metric.H_BEST)


def _css_width(share: float) -> str:
    return f"{100.0 * min(max(share, 0.0), 1.0):.1f}%"
