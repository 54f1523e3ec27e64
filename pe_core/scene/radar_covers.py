"""Parts of the vehicle that radars measure through: a bumper's skin, a badge."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from ..base.errors import InputError, shown
from ..base.read_only import ReadOnlyDict
from ..base.values import Number

LOSS_DB = Number(0.0, 100.0, unit="dB", noun="loss")


def checked_covers(covers: Any, names: Sequence[str]) -> Mapping[str, float]:
    """Return the loss of covers, one way, by part [dB].

    Raises
    ------
    InputError
        When it is no table, a part is unknown (near names are offered), or a loss is impossible.
    """
    if not isinstance(covers, Mapping):
        raise InputError("vehicle", "covers", "a table of parts and losses", shown(covers))
    for name in covers:
        if name not in names:
            near = get_close_matches(str(name), names, n=3, cutoff=0.4) or list(names)[:5]
            raise InputError("vehicle", "covers", f"a part such as {', '.join(near)}", shown(name))
    items = covers.items()
    return ReadOnlyDict({k: LOSS_DB.checked("vehicle", f"covers.{k}", v) for k, v in items})
