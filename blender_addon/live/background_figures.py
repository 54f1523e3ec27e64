"""Key figures below a live score: blind ground, reach and expected AP.

They are requested once the scene is idle. Figures of a rig are computed once.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from functools import partial

import bpy

from .. import analysis_calls, bridge, engine_process, signals
from ..engine import advice, pe, text
from ..engine_calls import Problem, ScoreRequest, rig_key
from .readout_text import ReadoutLine, figure_lines
from .state import Baseline, FigureRequest, LiveScore, ShownFigures, live_state, states

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
    """Yield lines of key figures, and whether they are of what is shown."""
    figures = figures_of(scene_name, score, exact)
    for line in () if figures is None else figure_lines(figures):
        if line:
            yield line, figures is not None and figures.current


def cancel(scene_name: str) -> None:
    """Drop the requests of a scene."""
    engine_process.drop(f"live figures of {scene_name}")


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


def _failed(error: Exception) -> None:
    """Show nothing where a figure cannot be computed; let Blender report our own mistakes."""
    if not isinstance(error, pe.InputError):
        raise error
