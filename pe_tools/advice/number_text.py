"""Format numbers for readers: few digits, with units, no more digits than are meaningful."""

from __future__ import annotations

from collections.abc import Sequence


def percent(share: float, digits: int | None = None) -> str:
    """Return a share, 0 to 1, in percent with `digits` decimals: "81.4%".

    Without `digits`: "85%" as in a sentence, with one decimal for shares near 0 or 1: "0.4%".
    """
    if digits is not None:
        return f"{100.0 * share:.{digits}f}%"
    value = 100.0 * share
    if 0.0 < value < 0.05:
        return "under 0.1%"
    if 99.95 <= value < 100.0:
        return "over 99.9%"
    return f"{value:.1f}%" if 0.0 < value < 9.95 or 99.5 <= value < 100.0 else f"{value:.0f}%"


def metres(length: float) -> str:
    """Return a length [m] as "5 cm", "1.45 m" or "84 m"."""
    if abs(length) < 0.995:
        return f"{100.0 * length:.0f} cm"
    return f"{length:.2f} m" if abs(length) < 9.995 else f"{length:.0f} m"


def times(factor: float) -> str:
    """Return a factor as "12 times" or "0.31 times"."""
    return f"{factor:.0f} times" if factor >= 9.5 else f"{factor:.2g} times"


def joined(texts: Sequence[str]) -> str:
    """Join texts: "a", "a and b", "a, b and c"."""
    if len(texts) < 2:
        return "".join(texts)
    return f"{', '.join(texts[:-1])} and {texts[-1]}"
