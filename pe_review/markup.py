"""HTML from plain values: everything that is not written here is escaped."""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Iterable, Sequence
from typing import Any

KEPT = "\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}"
"""Do not print, but stand in our own figures."""
UNSAFE = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"}
"""What could end a script, or begin a comment in one; JSON's strings may also be written so."""


def escaped(text: object) -> str:
    """Return a text as HTML, also fit for an attribute; what does not print is written out."""
    shown = "".join(c if c.isprintable() or c in KEPT else ascii(c)[1:-1] for c in str(text))
    return html.escape(shown.encode("utf-8", "backslashreplace").decode(), quote=True)


def css_string(text: object) -> str:
    """Return a text as a string of a style sheet."""
    shown = "".join(c if c.isprintable() else " " for c in str(text))
    unsafe = '"\\<>&'
    inside = "".join(f"\\{ord(c):06x}" if c in unsafe else c for c in shown)
    return f'"{inside.encode("utf-8", "replace").decode()}"'


def script_json(data: Any) -> str:
    """Return plain data as JSON that can stand in a script element."""
    text = json.dumps(data, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    for found, written in UNSAFE.items():
        text = text.replace(found, written)
    return text


def picture(png: bytes, alt: str, caption: str = "", css: str = "") -> str:
    """Return a figure of a PNG (HTML in its caption), its content in the page itself."""
    source = f"data:image/png;base64,{base64.b64encode(png).decode()}"
    below = f"<figcaption>{caption}</figcaption>" if caption else ""
    image = f'<img src="{source}" alt="{escaped(alt)}">'
    return f'<figure class="{escaped(css)}">{image}{below}</figure>'


def table(
    caption: str, heads: Sequence[str], rows: Iterable[Sequence[object]], *, css: str = ""
) -> str:
    """Return a table of plain texts: the first column heads its row, figures stand to the right.

    A cell that is `Markup` is taken as it is. A row of one cell heads the rows below it.
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
    """A text that is HTML already."""


def _row(row: Sequence[object]) -> str:
    first, *rest = row
    if not rest:
        return f'<tr class="head"><th scope="rowgroup" colspan="99">{_cell(first)}</th></tr>'
    return f'<tr><th scope="row">{_cell(first)}</th>{"".join(map(_figure, rest))}</tr>'


def _figure(value: object) -> str:
    return f"<td>{_cell(value)}</td>"


def _cell(value: object) -> str:
    return str(value) if isinstance(value, Markup) else escaped(value)
