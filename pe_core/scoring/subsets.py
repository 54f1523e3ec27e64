"""A rig and its parts: every sensor alone, and the rig without each sensor."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from ..metric.fusion import group_sum
from ..scene.sensors import Rig

Members = tuple[str, ...]


def parts_of(rig: Rig) -> list[Members]:
    """The whole rig, then each sensor alone, then the rig without each; only what differs."""
    names = tuple(s.name for s in rig)
    if len(names) == 1:
        return [names]
    alone = [(name,) for name in names]
    without = [tuple(n for n in names if n != name) for name in names]
    return [names, *dict.fromkeys([*alone, *without])]


def fused_early(
    rig: Rig, measured: Mapping[str, Any], members: Collection[str]
) -> list[tuple[str, Any]]:
    """Sum the members' measurements inside each fusion group, eq. 6: (kind, sum) of each."""
    groups = []
    for sensors in rig.groups.values():
        present = [measured[s.name] for s in sensors if s.name in members]
        if present:
            kind = sensors[0].kind
            groups.append((kind, group_sum(present)))
    return groups
