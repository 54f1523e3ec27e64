"""Words for numbers, each verdict with a stated tolerance; paragraphs and tables of Markdown."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from pathlib import Path

from pe_core import InputError
from pe_core.base import read_bytes

PAGE = "README.md"
LINE_WIDTH = 100

FIGURE_NATS = 0.1
"""Two entropies that differ by at most this are the same figure."""
LEVEL_NATS = 0.05
"""Two entropies that differ by at most this are nearly level."""
GAIN_NATS = 0.005
"""A smaller gain is none: it would be shown as 0.00."""
ABOUT_M = 0.25
"""Heights that differ by at most this on average are about the same, and a sensor that is this near
to a corner is at the corner: a tenth of the bus's height."""
APART_M, APART_DEG = 0.01, 0.1
"""Two LiDARs that differ by more than one of these have different heights or pitches."""
MOUNT_M = 0.5
"""A sensor that is this near to the paper's is at the paper's place."""
AT_BOUND_M = 0.2
"""A search that ends this near to a bound ends at the bound."""


def joined(names: Sequence[str]) -> str:
    """Return names as a sentence lists them: a, b and c."""
    if len(names) < 2:
        return "".join(names) or "none"
    return f"{', '.join(names[:-1])} and {names[-1]}"


def under(yes: Sequence[str], no: Sequence[str]) -> str:
    """Return under which priors something is true, from those where it is and those where not."""
    if not no:
        return "under every prior"
    return f"under {joined(yes)} alone" if yes else "under no prior"


def how_many(count: int, total: int) -> str:
    """Return how many of all, as the subject of a sentence: none, both, all, or 2 of 5."""
    if count in (0, total):
        return "none" if not count else "both" if total == 2 else "all"
    return f"{count} of {total}"


def compared(ours: float, theirs: float, tolerance: float, same: str = "the same") -> str:
    """Return whether a figure is higher than another, lower, or the same within a tolerance."""
    if abs(ours - theirs) <= tolerance:
        return same
    return "higher" if ours > theirs else "lower"


def compared_with_printed(ours: Sequence[float], printed: Sequence[float]) -> str:
    """Return how figures compare with the printed ones."""
    words = [
        compared(a, b, FIGURE_NATS, f"the same to {FIGURE_NATS}")
        for a, b in zip(ours, printed, strict=True)
    ]
    return words[0] if len(set(words)) == 1 else joined(words)


def gain_text(gain: float) -> str:
    """Return how much better or worse a placement is than the paper's [nats]."""
    if abs(gain) < GAIN_NATS:
        return f"as good as at the paper's place, to {GAIN_NATS} nats"
    return f"{abs(gain):.2f} nats {'better' if gain > 0.0 else 'worse'} than at the paper's place"


def range_text(values: Sequence[float], digits: int = 2) -> str:
    """Return the range of some numbers: 1.20 to 1.35."""
    low, high = (f"{v:.{digits}f}" for v in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    rule = ["---"] * len(head)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (head, rule, *lines))


def wrapped(sections: Iterable[str]) -> str:
    """Return sections of Markdown as one page, in lines of even width."""
    blocks = (block for section in sections for block in section.strip().split("\n\n"))
    return "\n\n".join(map(_wrapped_block, blocks)) + "\n"


def _wrapped_block(block: str) -> str:
    """Return a paragraph in lines of even width; tables, headings and lists as they are."""
    if block.startswith(("|", "#", "-", "!")):
        return block
    return textwrap.fill(block, LINE_WIDTH, break_long_words=False, break_on_hyphens=False)


def check_page(folder: Path, title: str, verb: str) -> None:
    """Raise `InputError` when the folder has a page that the verb did not write."""
    path = folder / PAGE
    if path.is_file() and not read_bytes(path).startswith(title.encode()):
        found = "another page, which is kept; choose another folder"
        raise InputError(path, "output", f"no file, or a page of {verb}", found)
