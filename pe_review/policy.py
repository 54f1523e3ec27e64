"""The page's content security policy: it runs and loads what it was made with, and nothing else.

Scripts and style sheets are allowed by their SHA-256. Style attributes cannot be, so there are
none: each becomes a rule of a style sheet, found by a number.
"""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterable

STYLE_ATTRIBUTE = re.compile(r' style="([^"]*)"')


def policy(styles: Iterable[str], scripts: Iterable[str]) -> str:
    """Return the policy of a page with these style sheets and scripts, as they stand in it."""
    return "; ".join(
        (
            "default-src 'none'",
            "img-src data: blob:",
            f"style-src {_hashes(styles)}",
            f"script-src {_hashes(scripts)}",
            "base-uri 'none'",
            "form-action 'none'",
        )
    )


def without_style_attributes(html: str) -> tuple[str, str]:
    """Return HTML whose style attributes are numbers, and the style sheet that has their rules.

    The texts of the HTML are escaped: a quotation mark ends an attribute, and nothing else.
    """
    rules: dict[str, int] = {}

    def numbered(found: re.Match[str]) -> str:
        return f' data-s="{rules.setdefault(found[1], len(rules))}"'

    html = STYLE_ATTRIBUTE.sub(numbered, html)
    # Named twice: as an attribute would, a rule goes before those of classes.
    sheet = "\n".join(f'[data-s="{n}"][data-s][data-s]{{{rule}}}' for rule, n in rules.items())
    return html, sheet


def _hashes(contents: Iterable[str]) -> str:
    found = [hashlib.sha256(content.encode("utf-8")).digest() for content in contents]
    each = dict.fromkeys(f"'sha256-{base64.b64encode(own).decode()}'" for own in found)
    return " ".join(each) or "'none'"
