"""Tables as CSV in which a spreadsheet finds texts, never formulas.

A spreadsheet computes what begins with ``=``, ``+``, ``-`` or ``@``, and a name may come from
anybody's file. Such a text gets an apostrophe in front (OWASP, "CSV injection"); our own readers
take it off again.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable

from .files import NUMBER

MARK = "'"
_FORMULA = re.compile(rf"{MARK}*[=+\-@\t\r\uff1d\uff0b\uff0d\uff20]")
"""Apostrophes count: a text that has one already gets another, so that it can be told apart."""
_NUMBERS = re.compile(rf"{NUMBER.pattern}( {NUMBER.pattern})*", re.ASCII)


def csv_text(rows: Iterable[Iterable[object]], *, quote_texts: bool = False) -> str:
    """Return rows as CSV: None is an empty cell, texts that look like formulas are marked.

    Parameters
    ----------
    rows : iterable of iterable
    quote_texts : bool
        Whether every text is in quotes, not only those that need them.
    """
    text = io.StringIO()
    if quote_texts:
        writer = csv.writer(text, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC)
    else:
        writer = csv.writer(text, lineterminator="\n")
    writer.writerows([marked(c) if isinstance(c, str) else c for c in row] for row in rows)
    return text.getvalue()


def marked(text: str) -> str:
    """Return a text as a cell: with an apostrophe in front if it looks like a formula."""
    is_formula = _FORMULA.match(text) and not _NUMBERS.fullmatch(text)
    return MARK + text if is_formula else text


def unmarked(cell: str) -> str:
    """Return the text of a cell that `marked` made."""
    return cell[1:] if cell.startswith(MARK) and _FORMULA.match(cell) else cell
