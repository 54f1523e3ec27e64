"""Key figures below a live score: blind ground, reach, expected AP, and a known rig's score.

They are requested once the scene is idle. Figures of a rig are computed once.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import replace
from functools import partial

import bpy

from .. import analysis_calls, bridge, engine_process, signals
from ..choices import NO_ANCHOR
from ..engine import advice, catalog, pe, text
from ..engine_calls import Problem, ScoreRequest, rig_key
from .readout_text import ReadoutLine, figure_lines, known_rig_line
from .state import (
    Baseline,
    FigureRequest,
    KnownRigScore,
    LiveScore,
    ShownFigures,
    live_state,
    states,
)

figure_cache: text.RecentCache[advice.KeyFigures] = text.RecentCache(24)
"""By problem, rule and rig: those of the last moves, and what they are compared with."""


def rule_of(scene: bpy.types.Scene, prior: pe.Prior) -> bridge.FigureRule | None:
    """Return the height and class that figures are of; None where no figures are wanted."""
    return bridge.figure_rule(scene, prior) if scene.perception_entropy.live.figures else None


def request(scene: bpy.types.Scene, score: ScoreRequest, baseline: Baseline | None) -> None:
    """Request the figures of an idle scene that are not known yet."""
    name, rule, problem = scene.name, rule_of(scene, score.problem.prior), score.problem
    live_state(name).figures = FigureRequest(score, baseline, rule)
    rigs = [score.rig, *([baseline.rig] if baseline is not None and baseline.rig else [])]
    missing = [rig for rig in rigs if figure_cache.get(_key(problem, rule, rig)) is None]
    if rule is not None and missing:
        given = problem, rule.height, rule.class_name, missing
        deliver = partial(_keep, problem, rule, missing)
        topic = f"live figures of {name}"
        engine_process.ask(topic, analysis_calls.key_figures, given, deliver, _failed)
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


def lines_below(
    scene_name: str, score: LiveScore, exact: bool
) -> Iterator[tuple[ReadoutLine, bool]]:
    """Yield lines of key figures and of a known rig, and whether they are of what is shown."""
    figures, known_rig = figures_of(scene_name, score, exact), live_state(scene_name).known_rig
    for line in () if figures is None else figure_lines(figures):
        if line:
            yield line, figures is not None and figures.current
    if known_rig is not None and (line := known_rig_line(known_rig, score.summary)):
        yield line, False


def cancel(scene_name: str) -> None:
    """Drop the requests of a scene."""
    for topic in ("figures", "anchor"):
        engine_process.drop(f"live {topic} of {scene_name}")


def clear() -> None:
    """Drop all requests and figures: another file is opened."""
    for name in list(states):
        cancel(name)
    figure_cache.clear()


def _key(problem: Problem, rule: bridge.FigureRule | None, rig: pe.Rig) -> Hashable:
    return problem.key, rule, rig_key(rig)


def _keep(
    problem: Problem, rule: bridge.FigureRule, rigs: list[pe.Rig], figures: list[advice.KeyFigures]
) -> None:
    for rig, found in zip(rigs, figures, strict=True):
        figure_cache.put(_key(problem, rule, rig), found)
    signals.live_score_changed.emit()


def _request_known_rig(name: str, problem: Problem, chosen: str) -> None:
    """Have the chosen rig scored on this vehicle, once for each problem."""
    state, key = live_state(name), (problem.key, chosen)
    if chosen == NO_ANCHOR:
        state.known_rig = None
    elif state.known_rig is None or state.known_rig.key != key:
        rig = catalog.known_rig(chosen)
        state.known_rig = KnownRigScore(key, rig.title)
        deliver, topic = partial(_deliver_known_rig, name, key), f"live anchor of {name}"
        given = problem, rig
        engine_process.ask(topic, analysis_calls.known_rig_score, given, deliver, _failed)


def _deliver_known_rig(name: str, key: Hashable, summary: pe.SummaryScore) -> None:
    state = live_state(name)
    if state.known_rig is not None and state.known_rig.key == key:
        state.known_rig = replace(state.known_rig, summary=summary)
        signals.live_score_changed.emit()


def _failed(error: Exception) -> None:
    """Show nothing where a figure cannot be computed; let Blender report our own mistakes."""
    if not isinstance(error, pe.InputError):
        raise error
