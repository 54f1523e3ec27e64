"""Part names from other programs' files, made valid for messages, studies and the screen."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from pe_core.base.errors import InputError
from pe_core.base.values import A_NAME, MAX_NAME

INSTEAD = "?"
"""What stands for a character that cannot be printed, and for a name without any that can."""
MAX_NUMBER_DIGITS = 12
"""Characters kept free for a number behind a name."""


def fit_names(names: Sequence[str]) -> tuple[str, ...]:
    """Return a name for each part: all different, printable, on one line and not too long.

    Valid names are unchanged. In other names `INSTEAD` replaces characters that cannot be printed
    (line ends, controls, changes of the text direction, halves of a surrogate pair). Long names are
    cut at the end. A number makes names different that would become equal.

    Parameters
    ----------
    names : sequence of str
        All different.
    """
    taken = {name for name in names if _is_fit(name)}
    used: Counter[str] = Counter()
    return tuple(name if name in taken else _new_name(name, taken, used) for name in names)


def _is_fit(name: str) -> bool:
    try:
        A_NAME.checked("mesh", "part", name)
    except InputError:
        return False
    return True


def _new_name(name: str, taken: set[str], used: Counter[str]) -> str:
    start = name[: MAX_NAME - MAX_NUMBER_DIGITS]
    base = "".join(c if c.isprintable() else INSTEAD for c in start).strip() or INSTEAD
    fit = base
    while not used[base] or fit in taken:
        used[base] += 1
        fit = base if used[base] == 1 else f"{base} ({used[base]})"
    taken.add(fit)
    return fit
