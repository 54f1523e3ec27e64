"""Words for figures: verdicts chosen from numbers, each by a stated tolerance."""

from __future__ import annotations

from collections.abc import Sequence

FIGURE_NATS = 0.1
"""An entropy this near to the printed one is the printed one."""
LEVEL_NATS = 0.05
"""Two entropies this near to each other are nearly level."""
GAIN_NATS = 0.005
"""A gain below this is none: it would be shown as 0.00."""
ABOUT_M = 0.25
"""Heights this near on average are about the same, and a sensor this near to a corner is at it: a
tenth of the bus's height."""
APART_M, APART_DEG = 0.01, 0.1
"""Two LiDARs farther apart than either are not at the same height and pitch."""
MOUNT_M = 0.5
"""A sensor this near to the paper's is at the paper's place."""
AT_BOUND_M = 0.2
"""A search that ends this near to a bound ends at it."""

LONGEST_NAME = 48
"""Characters of a name that a plot has room for."""


def one_line(name: str, longest: int = LONGEST_NAME) -> str:
    """Return a name from a file as it can be shown: one line, nothing unprintable, not long."""
    line = "".join(c if c.isprintable() else "?" for c in name)
    return line if len(line) <= longest else f"{line[: longest - 3]}..."


def joined(names: Sequence[str]) -> str:
    """Return names as in a sentence."""
    if len(names) < 2:
        return "".join(names) or "none"
    return f"{', '.join(names[:-1])} and {names[-1]}"


def under(yes: Sequence[str], no: Sequence[str]) -> str:
    """Return under which priors something is so."""
    if not no:
        return "under every prior"
    return f"under {joined(yes)} alone" if yes else "under no prior"


def how_many(yes: int, every: int) -> str:
    """Return how many of all are so, as the beginning of a sentence about them."""
    if yes in (0, every):
        return "none" if not yes else "both" if every == 2 else "all"
    return f"{yes} of {every}"


def against(ours: float, theirs: float, tolerance: float, same: str = "the same") -> str:
    """Return whether a figure is higher than another, lower, or the same within a tolerance."""
    if abs(ours - theirs) <= tolerance:
        return same
    return "higher" if ours > theirs else "lower"


def than_printed(ours: Sequence[float], printed: Sequence[float]) -> str:
    """Return how figures compare with the printed ones."""
    words = [
        against(a, b, FIGURE_NATS, f"the same to {FIGURE_NATS}")
        for a, b in zip(ours, printed, strict=True)
    ]
    return words[0] if len(set(words)) == 1 else joined(words)


def better_by(gain: float) -> str:
    """Return how much better a placement is than the paper's, or worse [nats]."""
    if abs(gain) < GAIN_NATS:
        return f"as good as at the paper's place, to {GAIN_NATS} nats"
    return f"{abs(gain):.2f} nats {'better' if gain > 0.0 else 'worse'} than at the paper's place"


def between(values: Sequence[float], digits: int = 2) -> str:
    """Return the range of some numbers."""
    low, high = (f"{v:.{digits}f}" for v in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def table(head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    rule = ["---"] * len(head)
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (head, rule, *lines))
