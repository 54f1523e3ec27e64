"""What stands below a live score: blind ground, reach, expected AP, and a known rig's score.

Asked of the background worker once things rest, so that it keeps nothing waiting that follows the
hand. What is known of a rig is not worked out again.
"""

from __future__ import annotations

import threading
from collections.abc import Hashable
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import bpy

from .. import bridge, changes, worker
from ..choices import NO_ANCHOR
from ..engine import advice, catalog, pe, sight
from . import latest
from .asking import EvaluatorStore, Problem, ScoreWish, light
from .reference import Baseline, rig_key

KEPT = 24
"""Rigs whose figures are kept: those of the last moves, and what they are compared with."""


class FigureStore:
    """Key figures by problem, rule and rig; what is asked for last is kept."""

    def __init__(self) -> None:
        self._known: dict[Hashable, advice.KeyFigures] = {}
        self._lock = threading.Lock()

    def get(self, key: Hashable) -> advice.KeyFigures | None:
        """Return what is known."""
        with self._lock:
            return self._known.get(key)

    def put(self, key: Hashable, found: advice.KeyFigures) -> None:
        """Keep figures; the oldest are let go."""
        with self._lock:
            self._known.pop(key, None)
            self._known[key] = found
            while len(self._known) > KEPT:
                del self._known[next(iter(self._known))]

    def clear(self) -> None:
        """Forget all."""
        with self._lock:
            self._known.clear()


known = FigureStore()


class SightCache:
    """What tells what rigs see, of the problem that was asked about last. For one thread alone."""

    def __init__(self) -> None:
        self._key: Hashable = None
        self._sight: sight.Sight | None = None

    def sight_of(self, problem: Problem) -> sight.Sight:
        """Return what tells it, made anew for another problem."""
        if self._sight is None or self._key != problem.key:
            self._sight = None  # two of them need not fit in memory
            vehicle, _ = light(problem.vehicle)
            parts = problem.space, problem.prior, vehicle
            self._sight = sight.Sight(*parts, model=problem.model)
            self._key = problem.key
        return self._sight


_sight_cache = SightCache()


@dataclass(frozen=True, slots=True)
class Anchor:
    """A known rig on this vehicle, scored as the live score is; `glance` is None until it is."""

    key: Hashable
    title: str
    glance: pe.Glance | None = None


class ShownFigures(NamedTuple):
    """Key figures to show, those they are compared with, and whether they are of the scene."""

    now: advice.KeyFigures | None = None
    before: advice.KeyFigures | None = None
    current: bool = False


class _Asked(NamedTuple):
    """What was asked of a scene that rested: of which wish, compared with what, by which rule."""

    wish: ScoreWish
    reference: Baseline | None
    rule: bridge.FigureRule | None


_asked: dict[str, _Asked] = {}
_shown: dict[str, advice.KeyFigures] = {}
_anchors: dict[str, Anchor] = {}
"""By the scene's name."""


def rule_of(scene: bpy.types.Scene, prior: pe.Prior) -> bridge.FigureRule | None:
    """Return what figures are told of; None where none are wanted."""
    return bridge.figure_rule(scene, prior) if scene.perception_entropy.live.figures else None


def ask(scene: bpy.types.Scene, wish: ScoreWish, reference: Baseline | None) -> None:
    """Ask for what is not known yet of a scene at rest."""
    name, rule = scene.name, rule_of(scene, wish.problem.prior)
    _asked[name] = _Asked(wish, reference, rule)
    problem, rigs = wish.problem, _rigs(_asked[name])
    unknown = [rig for rig in rigs if known.get(_key(problem, rule, rig)) is None]
    if rule is not None and unknown:
        work = partial(_work_out, problem, rule, unknown)
        worker.desk.ask(f"live figures of {name}", work, _tell, _failed)
    _ask_anchor(name, problem, scene.perception_entropy.live.anchor)


def ask_again(scene: bpy.types.Scene) -> None:
    """Ask once more where another height or class is chosen than was asked for."""
    asked = _asked.get(scene.name)
    if asked is not None and rule_of(scene, asked.wish.problem.prior) != asked.rule:
        ask(scene, asked.wish, asked.reference)


def figures_of(scene_name: str, reading: latest.Reading, exact: bool) -> ShownFigures | None:
    """Return the figures to show beside a reading: of before it, where its own are not known yet.

    None where none are wanted.
    """
    asked = _asked.get(scene_name)
    if asked is None or asked.rule is None:
        return None
    problem, rule, reference = asked.wish.problem, asked.rule, reading.reference
    now = known.get(_key(problem, rule, reading.rig)) if exact else None
    if now is None:
        return ShownFigures(_shown.get(scene_name))
    _shown[scene_name] = now
    rig = None if reference is None else reference.rig
    before = None if rig is None else known.get(_key(problem, rule, rig))
    return ShownFigures(now, before, current=True)


def anchor_of(scene_name: str) -> Anchor | None:
    """Return the known rig that a scene's score is told beside; None where there is none."""
    found = _anchors.get(scene_name)
    return None if found is None or found.glance is None else found


def drop(scene_name: str) -> None:
    """Forget what was asked of a scene."""
    for topic in ("figures", "anchor"):
        worker.desk.drop(f"live {topic} of {scene_name}")
    for each in (_asked, _shown, _anchors):
        each.pop(scene_name, None)


def forget() -> None:
    """Forget everything: another file comes."""
    for name in {*_asked, *_anchors}:
        drop(name)
    known.clear()


def _key(problem: Problem, rule: bridge.FigureRule | None, rig: pe.Rig) -> Hashable:
    return problem.key, rule, rig_key(rig)


def _rigs(asked: _Asked) -> list[pe.Rig]:
    """The rig that rests, and the one it is compared with."""
    other = None if asked.reference is None else asked.reference.rig
    return [asked.wish.rig, *([] if other is None else [other])]


def _work_out(problem: Problem, rule: bridge.FigureRule, rigs: list[pe.Rig]) -> None:
    """In the thread: work out figures; what is known by now is left."""
    looking, voxels = _sight_cache.sight_of(problem), not problem.targets.are_objects
    for rig in rigs:
        found = advice.key_figures(looking, rig, rule.height, rule.class_name, of_voxels=voxels)
        known.put(_key(problem, rule, rig), found)


def _ask_anchor(name: str, problem: Problem, chosen: str) -> None:
    """Have the chosen rig scored on this vehicle, once for each problem."""
    key = problem.key, chosen
    if chosen == NO_ANCHOR:
        _anchors.pop(name, None)
    elif name not in _anchors or _anchors[name].key != key:
        rig = catalog.known_rig(chosen)
        _anchors[name] = Anchor(key, rig.title)
        work = partial(_score_anchor, problem, rig)
        deliver = partial(_deliver_anchor, name, key)
        worker.desk.ask(f"live anchor of {name}", work, deliver, _failed)


def _score_anchor(problem: Problem, known_rig: catalog.KnownRig) -> pe.Glance:
    """In the thread: score a known rig, by an evaluator of its own."""
    rig = catalog.rig_on(known_rig, problem.vehicle)
    return EvaluatorStore().glance("", ScoreWish(problem, rig, draft=False))[0]


def _deliver_anchor(name: str, key: Hashable, found: pe.Glance) -> None:
    if name in _anchors and _anchors[name].key == key:
        _anchors[name] = replace(_anchors[name], glance=found)
        changes.reading.tell()


def _tell(_found: None) -> None:
    changes.reading.tell()


def _failed(error: Exception) -> None:
    """Show nothing where a figure cannot be told; a mistake of ours is Blender's to tell."""
    if not isinstance(error, pe.InputError):
        raise error
