"""What a live score is compared with: the sensors before the last move, pinned ones, a variant.

A move lasts as long as the operator that moves with the mouse. Blender ends the operator before the
update that puts the sensors where they were released, or back where they were: the first update
without an operator still belongs to the move. An update that moves no sensor begins none.
"""

from __future__ import annotations

import bpy

from .. import bridge
from ..choices import BEFORE_MOVE, PINNED
from ..engine import pe
from .evaluation import ScoreRequest
from .state import Baseline, ChosenBaseline, LiveState, live_state, rig_key

MOVE_LABEL, PINNED_LABEL = "before this move", "pinned sensors"


def note_move(state: LiveState, operator: int, now: pe.Rig | None) -> None:
    """Note an update in which something moves; keep what was there before where a move begins.

    Parameters
    ----------
    state : LiveState
        As it was before this update.
    operator : int
        Number of the operator that moves with the mouse; 0 when there is none.
    now : Rig or None
        The rig that was read in this update; None when it is the vehicle that moves.
    """
    if state.operator and operator in (0, state.operator):
        state.operator = operator
        return
    last = state.last_read
    if last is None or (now is not None and rig_key(now) == rig_key(last.rig)):
        return
    state.operator = operator
    summary = _exact_summary(state)
    if operator or summary is not None:  # otherwise a field is dragged, or typed in several times
        rig = None if now is None else last.rig
        state.before_move = Baseline(MOVE_LABEL, rig, summary)


def _exact_summary(state: LiveState) -> pe.Glance | None:
    """Return the exact score of the rig that was read last, where it is there already."""
    exact, last = state.exact, state.last_read
    if exact is None or last is None or exact.problem != last.problem:
        return None
    return exact.summary if rig_key(exact.rig) == rig_key(last.rig) else None


def baseline_of(scene: bpy.types.Scene, request: ScoreRequest) -> Baseline | None:
    """Return what a scene is compared with, as its settings choose; None where nothing is yet.

    A variant is read again whenever the scene is idle; while sensors move it stays what it was.
    """
    state, choice = live_state(scene.name), scene.perception_entropy.live.against
    chosen = state.chosen
    if chosen is not None and request.draft and chosen.key[:2] == (choice, request.problem.key):
        return chosen.baseline
    rig_and_label = _chosen_rig(scene, state, choice)
    if rig_and_label is None:
        state.chosen = None
        return state.before_move
    rig, label = rig_and_label
    key = choice, request.problem.key, rig_key(rig), label
    if chosen is None or chosen.key != key:
        chosen = state.chosen = ChosenBaseline(key, Baseline(label, rig))
    return chosen.baseline


def _chosen_rig(scene: bpy.types.Scene, state: LiveState, choice: int) -> tuple[pe.Rig, str] | None:
    """Return the rig to compare with and its label; None where the last move decides."""
    if choice == PINNED:
        return None if state.pinned is None else (state.pinned, PINNED_LABEL)
    for row in scene.perception_entropy.variants if choice != BEFORE_MOVE else ():
        if row.key == choice:
            try:
                return bridge.rig_of(bridge.records_of(row)), row.name
            except pe.InputError:  # no sensor of it counts, or a model is not known here
                return None
    return None
