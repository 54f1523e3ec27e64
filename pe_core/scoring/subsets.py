"""A rig and its parts: every sensor alone, and the rig without each sensor."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..metric.fusion import CurveOf, group_sum
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
) -> list[tuple[CurveOf, Any]]:
    """Sum the members' measurements inside each fusion group, eq. 6: (AP curve, sum) of each."""
    groups = []
    for sensors in rig.groups.values():
        present = [measured[s.name] for s in sensors if s.name in members]
        if present:
            groups.append((sensors[0].curve or sensors[0].kind, group_sum(present)))
    return groups


def members_of(rig: Rig, measured: Mapping[str, Any]) -> list[list[tuple[CurveOf, Any]]]:
    """(AP curve, measurement) of each sensor of each fusion group."""
    return [[(s.curve or s.kind, measured[s.name]) for s in group] for group in rig.groups.values()]


def parts_by_sums(
    rig: Rig, whole: float, blind: float, by_sensor: NDArray[np.float64]
) -> dict[Members, NDArray[np.float64]]:
    """Entropy and coverage, weighed (2, 1), of each sensor alone and of the rig without each.

    `whole` and `blind` are the weighed entropies of the rig and of no sensor; `by_sensor` (3, S)
    what `MemberSums` found. Coverage is left out (0) of what is no sensor alone.
    """
    names = tuple(s.name for s in rig)
    order = [s.name for sensors in rig.groups.values() for s in sensors]
    lost, gained, seen = (dict(zip(order, own, strict=True)) for own in by_sensor)
    rest = {tuple(n for n in names if n != name): [whole + lost[name], 0.0] for name in names}
    alone = {(name,): [blind + gained[name], seen[name]] for name in names}
    return {part: np.array(sums)[:, None] for part, sums in (rest | alone).items()}
