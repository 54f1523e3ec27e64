"""What a scene's live score is compared with, as its settings choose it."""

from __future__ import annotations

from collections.abc import Hashable
from typing import NamedTuple

import bpy

from .. import bridge
from ..choices import BEFORE_MOVE, PINNED
from ..engine import pe
from .asking import ScoreWish
from .reference import PINNED_LABEL, Baseline, Moves, rig_key


class _ChosenBaseline(NamedTuple):
    """A reference, and what it was made of."""

    key: Hashable
    reference: Baseline


_pinned: dict[str, pe.Rig] = {}
_chosen: dict[str, _ChosenBaseline] = {}
"""By the scene's name."""


def pin(scene_name: str, rig: pe.Rig) -> None:
    """Keep sensors to compare with, for this session."""
    _pinned[scene_name] = rig


def is_pinned(scene_name: str) -> bool:
    """Whether sensors are kept to compare with."""
    return scene_name in _pinned


def reference_of(scene: bpy.types.Scene, wish: ScoreWish, moves: Moves) -> Baseline | None:
    """Return what a scene is compared with; None where there is nothing yet.

    A variant is read again whenever things rest; while they move it stays what it was.
    """
    name, choice = scene.name, scene.perception_entropy.live.against
    known = _chosen.get(name)
    if known is not None and wish.draft and known.key[:2] == (choice, wish.problem.key):
        return known.reference
    found = _rig_of(scene, choice)
    if found is None:
        _chosen.pop(name, None)
        return moves.before(name)
    rig, label = found
    key = choice, wish.problem.key, rig_key(rig), label
    if known is None or known.key != key:
        known = _chosen[name] = _ChosenBaseline(key, Baseline(label, rig))
    return known.reference


def _rig_of(scene: bpy.types.Scene, choice: int) -> tuple[pe.Rig, str] | None:
    """Sensors to compare with and what they are called; None where a move decides."""
    if choice == PINNED:
        rig = _pinned.get(scene.name)
        return None if rig is None else (rig, PINNED_LABEL)
    for row in scene.perception_entropy.variants if choice != BEFORE_MOVE else ():
        if row.key == choice:
            try:
                return bridge.rig_of(bridge.records_of(row)), row.name
            except pe.InputError:  # none of its sensors counts, or one is not known here
                return None
    return None


def forget() -> None:
    """Forget what was pinned and chosen: another file comes."""
    _pinned.clear()
    _chosen.clear()
