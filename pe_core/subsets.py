"""A rig and its parts: every sensor alone, and the rig without each sensor."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from .fusion import Measurement
from .sensors import Rig

Names = tuple[str, ...]


def parts_of(rig: Rig) -> list[Names]:
    """The whole rig, then each sensor alone, then the rig without each; only what differs."""
    names = tuple(s.name for s in rig)
    if len(names) == 1:
        return [names]
    alone = [(name,) for name in names]
    without = [tuple(n for n in names if n != name) for name in names]
    return [names, *dict.fromkeys([*alone, *without])]


def fused_early(
    rig: Rig, measured: Mapping[str, NDArray], members: Collection[str]
) -> list[Measurement]:
    """Sum the members' measurements inside each fusion group, eq. 6."""
    groups: list[Measurement] = []
    for sensors in rig.groups.values():
        present = [measured[s.name] for s in sensors if s.name in members]
        if len(present) == 1:
            groups.append((sensors[0].kind, present[0]))
        elif present:
            wide = float if sensors[0].kind == "camera" else np.int64
            groups.append((sensors[0].kind, np.sum(present, axis=0, dtype=wide)))
    return groups
