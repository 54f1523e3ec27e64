"""The templates of the page, and how they write values: escaped, with units and signs.
Every value that a template writes is escaped, and characters that do not print are spelled out."""

from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from pe_core import metric
from pe_core.base.errors import plural
from pe_core.scoring.sight import shown_end, shown_start

from .. import advice, graphics
from ..templating import Markup, Templates, escape
from ..wording import degrees, margin_text, unseen_text, verdict_text

TEMPLATES = Path(__file__).with_name("templates")
ALLOWED_SPACES = "\N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}"
"""Spaces that count as not printable, but occur in texts of this page."""
MINUS = "\N{MINUS SIGN}"
joined = advice.joined
percent = advice.percent


def render(template: str, **values: Any) -> Markup:
    """Return a template of the page's folder filled with values."""
    return Markup(_templates().render(template, **values))


def macros() -> Any:
    """Return the macros that templates share, as functions that return markup."""
    return SimpleNamespace(**_templates().module("macros.html"))


@cache
def _templates() -> Templates:
    own = (capitalized, joined, lines, number, percent, plural, points, signed, triple)
    filters: dict[str, Any] = {function.__name__: function for function in own}
    filters |= {
        "css_string": css_string,
        "degrees": degrees,
        "price": price_text,
        "error_text": advice.error_text,
        "shown_end": shown_end,
        "shown_start": shown_start,
        "at_least": lambda count: f"{count} points or more",
        "lone_reach": advice.lone_reach,
        "tall": lambda height: f"{height:g} m tall" if height else "flat on the ground",
        "margin": margin_text,
        "minus": lambda text: text.replace("-", MINUS),
        "unseen": unseen_text,
        "verdict": verdict_text,
        "study_name": lambda context: macros().study_name(context),
        "entropy_share": entropy_share,
        "hexadecimal": graphics.color_text,
        "where": lambda name: advice.WHERE.get(name, name),
    }
    return Templates(TEMPLATES, filters, printable)


def printable(value: object) -> object:
    """Return a text with the characters that do not print spelled out; markup as it is."""
    if not isinstance(value, str) or isinstance(value, Markup) or value.isprintable():
        return value
    text = "".join(c if c.isprintable() or c in ALLOWED_SPACES else ascii(c)[1:-1] for c in value)
    return text.encode("utf-8", "backslashreplace").decode()


def escaped(text: object) -> Markup:
    """Return a text as HTML, also for attributes; markup as it is."""
    return escape(printable(text))


def lines(texts: Iterable[str]) -> Markup:
    """Return texts as lines, for preformatted elements."""
    return Markup("\n").join(map(escaped, texts))


def css_string(text: object) -> Markup:
    """Return a text as a CSS string."""
    shown = "".join(c if c.isprintable() else " " for c in str(text))
    inside = "".join(f"\\{ord(c):06x}" if c in '"\\<>&' else c for c in shown)
    return Markup(f'"{inside.encode("utf-8", "replace").decode()}"')


def number(value: float, digits: int = 2) -> str:
    """Return a number with that many decimals and a minus sign (U+2212); never "-0.00"."""
    text = f"{value:.{digits}f}"
    return text.lstrip("-") if not text.strip("-0.") else text.replace("-", MINUS)


def signed(value: float, digits: int = 2) -> str:
    """Return a number with its sign, plus or minus."""
    text = number(value, digits)
    return text if text[0] == MINUS or not text.strip("0.") else f"+{text}"


def points(share: float) -> str:
    """Return a difference of shares as "+3.2 points"."""
    return f"{signed(100.0 * share, 1)} points"


def price_text(price: float, currency: str) -> str:
    """Return a price with its currency: "12,500 EUR", "99.50"."""
    amount = f"{price:,.0f}" if float(price).is_integer() else f"{price:,.2f}"
    return f"{amount} {currency}".strip()


def triple(values: Sequence[float], digits: int = 2) -> str:
    """Return three numbers as "0.50, 0.00, 1.80"."""
    return ", ".join(number(v, digits) for v in values)


def capitalized(text: str) -> str:
    """Return a text with its first letter in upper case."""
    return text[:1].upper() + text[1:]


def entropy_share(nats: float) -> float:
    """Return where an entropy lies between the best value (0) and that of unseen voxels (1)."""
    return (nats - metric.H_BEST) / (metric.H_BLIND - metric.H_BEST)
