"""Key figures below a live score: blind ground, reach, expected AP, and a known rig's score.

They are requested from the background worker once the scene is idle, so that nothing that follows
the mouse waits for them. Figures of a rig are computed once.
"""

from __future__ import annotations

import threading
from collections.abc import Hashable
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import bpy

from .. import bridge, signals, worker
from ..choices import NO_ANCHOR
from ..engine import advice, catalog, pe, sight
from .evaluation import EvaluatorCache, Problem, ScoreRequest
from .state import Baseline, KnownRigScore, LiveScore, live_state, rig_key, states

MAX_RIGS = 24
"""Rigs whose figures are kept: those of the last moves, and what they are compared with."""


class FigureCache:
    """Key figures by problem, rule and rig; those that were stored last are kept."""

    def __init__(self) -> None:
        self._figures: dict[Hashable, advice.KeyFigures] = {}
        self._lock = threading.Lock()

    def get(self, key: Hashable) -> advice.KeyFigures | None:
        """Return the figures of a key, None where there are none."""
        with self._lock:
            return self._figures.get(key)

    def put(self, key: Hashable, figures: advice.KeyFigures) -> None:
        """Store figures; drop the oldest where there are too many."""
        with self._lock:
            self._figures.pop(key, None)
            self._figures[key] = figures
            while len(self._figures) > MAX_RIGS:
                del self._figures[next(iter(self._figures))]

    def clear(self) -> None:
        """Drop all figures."""
        with self._lock:
            self._figures.clear()


figure_cache = FigureCache()


class SightCache:
    """What computes visibility for the last problem. Used by one thread alone."""

    def __init__(self) -> None:
        self._key: Hashable = None
        self._sight: sight.Sight | None = None

    def sight_of(self, problem: Problem) -> sight.Sight:
        """Return what computes it; made again for another problem."""
        if self._sight is None or self._key != problem.key:
            self._sight = None  # two of them need not fit in memory
            place = problem.space, problem.prior, problem.vehicle
            self._sight = sight.Sight(*place, model=problem.model)
            self._key = problem.key
        return self._sight


_sight_cache = SightCache()


class FigureRequest(NamedTuple):
    """A request of key figures: for which score, compared with what, by which rule."""

    request: ScoreRequest
    baseline: Baseline | None
    rule: bridge.FigureRule | None


class ShownFigures(NamedTuple):
    """Key figures to show, those they are compared with, and whether they are of the scene."""

    now: advice.KeyFigures | None = None
    before: advice.KeyFigures | None = None
    current: bool = False


def rule_of(scene: bpy.types.Scene, prior: pe.Prior) -> bridge.FigureRule | None:
    """Return the height and class that figures are of; None where no figures are wanted."""
    return bridge.figure_rule(scene, prior) if scene.perception_entropy.live.figures else None


def request(scene: bpy.types.Scene, score: ScoreRequest, baseline: Baseline | None) -> None:
    """Request the figures of an idle scene that are not known yet."""
    name, rule, problem = scene.name, rule_of(scene, score.problem.prior), score.problem
    figures = live_state(name).figures = FigureRequest(score, baseline, rule)
    missing = [r for r in _rigs_of(figures) if figure_cache.get(_key(problem, rule, r)) is None]
    if rule is not None and missing:
        work = partial(_compute, problem, rule, missing)
        worker.background_worker.ask(f"live figures of {name}", work, _notify, _failed)
    _request_known_rig(name, problem, scene.perception_entropy.live.anchor)


def request_if_rule_changed(scene: bpy.types.Scene) -> None:
    """Request figures again where another height or class is chosen than before."""
    figures = live_state(scene.name).figures
    if figures is not None and rule_of(scene, figures.request.problem.prior) != figures.rule:
        request(scene, figures.request, figures.baseline)


def figures_of(scene_name: str, score: LiveScore, exact: bool) -> ShownFigures | None:
    """Return the figures to show beside a score: earlier ones, where its own are not known yet.

    None where no figures are wanted.
    """
    state = live_state(scene_name)
    if state.figures is None or state.figures.rule is None:
        return None
    problem, rule = state.figures.request.problem, state.figures.rule
    now = figure_cache.get(_key(problem, rule, score.rig)) if exact else None
    if now is None:
        return ShownFigures(state.shown_figures)
    state.shown_figures = now
    rig = None if score.baseline is None else score.baseline.rig
    before = None if rig is None else figure_cache.get(_key(problem, rule, rig))
    return ShownFigures(now, before, current=True)


def known_rig_score(scene_name: str) -> KnownRigScore | None:
    """Return the known rig beside a scene's live score; None until it is scored."""
    known_rig = live_state(scene_name).known_rig
    return None if known_rig is None or known_rig.summary is None else known_rig


def cancel(scene_name: str) -> None:
    """Drop the requests of a scene."""
    for topic in ("figures", "anchor"):
        worker.background_worker.drop(f"live {topic} of {scene_name}")


def clear() -> None:
    """Drop all requests and figures: another file is opened."""
    for name in list(states):
        cancel(name)
    figure_cache.clear()


def _key(problem: Problem, rule: bridge.FigureRule | None, rig: pe.Rig) -> Hashable:
    return problem.key, rule, rig_key(rig)


def _rigs_of(figures: FigureRequest) -> list[pe.Rig]:
    """Return the rig of the idle scene, and the one that it is compared with."""
    other = None if figures.baseline is None else figures.baseline.rig
    return [figures.request.rig, *([] if other is None else [other])]


def _compute(problem: Problem, rule: bridge.FigureRule, rigs: list[pe.Rig]) -> None:
    """On the worker's thread: compute the figures of rigs."""
    visibility, voxels = _sight_cache.sight_of(problem), not problem.targets.are_objects
    for rig in rigs:
        figures = advice.key_figures(
            visibility, rig, rule.height, rule.class_name, of_voxels=voxels
        )
        figure_cache.put(_key(problem, rule, rig), figures)


def _request_known_rig(name: str, problem: Problem, chosen: str) -> None:
    """Have the chosen rig scored on this vehicle, once for each problem."""
    state, key = live_state(name), (problem.key, chosen)
    if chosen == NO_ANCHOR:
        state.known_rig = None
    elif state.known_rig is None or state.known_rig.key != key:
        rig = catalog.known_rig(chosen)
        state.known_rig = KnownRigScore(key, rig.title)
        work = partial(_score_known_rig, problem, rig)
        deliver = partial(_deliver_known_rig, name, key)
        worker.background_worker.ask(f"live anchor of {name}", work, deliver, _failed)


def _score_known_rig(problem: Problem, known_rig: catalog.KnownRig) -> pe.SummaryScore:
    """On the worker's thread: score a known rig, by an evaluator of its own."""
    rig = catalog.rig_on(known_rig, problem.vehicle)
    return EvaluatorCache().summary("", ScoreRequest(problem, rig, preview=False))


def _deliver_known_rig(name: str, key: Hashable, summary: pe.SummaryScore) -> None:
    state = live_state(name)
    if state.known_rig is not None and state.known_rig.key == key:
        state.known_rig = replace(state.known_rig, summary=summary)
        signals.live_score_changed.emit()


def _notify(_result: None) -> None:
    signals.live_score_changed.emit()


def _failed(error: Exception) -> None:
    """Show nothing where a figure cannot be computed; let Blender report our own mistakes."""
    if not isinstance(error, pe.InputError):
        raise error
