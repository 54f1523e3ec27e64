"""Key figures of a live score: blind ground, reach and expected AP.

They are requested once the scene is idle. Figures of a rig are computed once.
"""

from collections.abc import Hashable
from functools import partial

import bpy

from .. import document, signals
from ..engine import advice, pe, search, text
from ..processes import analysis_calls, engine_process
from ..processes.engine_calls import Problem, ScoreRequest, rig_key
from .state import Baseline, live_state, states

figure_cache: text.RecentCache[advice.KeyFigures] = text.RecentCache(24)
"""By problem and rig: those of the last moves, and what they are compared with."""


def request(scene: bpy.types.Scene, score: ScoreRequest, baseline: Baseline | None) -> None:
    """Request the figures of an idle scene that are not known yet, where they are wanted."""
    name = scene.name
    problem = score.problem
    is_wanted = scene.perception_entropy.live.figures
    live_state(name).figures = problem if is_wanted else None
    if not is_wanted:
        return
    names = _shown(scene)
    rigs = [score.rig, *([baseline.rig] if baseline is not None and baseline.rig else [])]
    if missing := [rig for rig in rigs if figure_cache.get(_key(problem, rig, names)) is None]:
        deliver = partial(_keep, problem, missing, names)
        topic = f"live figures of {name}"
        engine_process.ask(
            topic, analysis_calls.key_figures, (problem, missing, names), deliver, fail=_failed
        )


def figures_of(scene: bpy.types.Scene) -> list[advice.KeyFigures]:
    """Return the figures to show of the live score, after those of what it is compared with. Those
    that were shown last while its own are not known; none where no figures are wanted."""
    state = live_state(scene.name)
    score = state.exact
    problem = state.figures
    if problem is None or score is None:
        return []
    names = _shown(scene)
    now = figure_cache.get(_key(problem, score.request.rig, names))
    if now is None or score is not state.score:
        return state.shown_figures[-1:]
    rig = None if score.baseline is None else score.baseline.rig
    before = None if rig is None else figure_cache.get(_key(problem, rig, names))
    state.shown_figures = [now] if before is None else [before, now]
    return state.shown_figures


def cancel(scene_name: str) -> None:
    """Drop the requests of a scene."""
    engine_process.drop(f"live figures of {scene_name}")


def clear() -> None:
    """Drop all requests and figures: another file is opened."""
    for name in list(states):
        cancel(name)
    figure_cache.clear()


def _shown(scene: bpy.types.Scene) -> tuple[str, ...]:
    settings = scene.perception_entropy
    return search.shown_figures(settings.figures, document.limits_of(settings))


def _key(problem: Problem, rig: pe.Rig, names: tuple[str, ...]) -> Hashable:
    return problem.key, rig_key(rig), names


def _keep(
    problem: Problem, rigs: list[pe.Rig], names: tuple[str, ...], figures: list[advice.KeyFigures]
) -> None:
    for rig, found in zip(rigs, figures, strict=True):
        figure_cache.put(_key(problem, rig, names), found)
    signals.live_score_changed.emit()


def _failed(error: Exception) -> None:
    """Show nothing where a figure cannot be computed; let Blender report our own mistakes."""
    if not isinstance(error, pe.InputError):
        raise error
