"""What the engine's process finds out for panels and views: figures, warnings, shapes of layers."""

from collections import defaultdict
from collections.abc import Generator, Sequence
from dataclasses import replace
from typing import Any

from ..engine import advice, graphics, pe, sight, text
from ..overlay.layer_cache import LayerCache
from ..overlay.layers import LAYERS, ShapeSteps
from ..overlay.request import ViewRequest
from . import engine_calls
from .engine_calls import Problem

_sight: text.RecentCache[sight.Sight] = text.RecentCache()
"""By the problem's key."""


def key_figures(
    problem: Problem, rigs: Sequence[pe.Rig], names: Sequence[str]
) -> list[advice.KeyFigures]:
    """Return those key figures of rigs that are named."""
    how = (problem.model, problem.targets)
    look = _sight.made(
        problem.key,
        lambda: sight.Sight(
            problem.space, problem.prior, problem.vehicle, model=how[0], targets=how[1]
        ),
    )
    return [advice.KeyFigures.of_rig(look, rig, names) for rig in rigs]


def warnings(
    sensors: list[pe.Sensor], vehicle: pe.Vehicle | None, space: pe.PerceptionSpace
) -> tuple[advice.Advice, ...]:
    """Return the warnings about sensors on a vehicle."""
    return advice.warnings(sensors, vehicle, space, pe.Prior.uniform())


def outlook(study: pe.Study) -> advice.Outlook:
    """Return how far a study's rig sees."""
    return advice.outlook(study.sight(), study.rig)


_beams: text.RecentCache[dict[str, Any]] = text.RecentCache()
"""Caches of kernels by vehicle: a body that moves has no beam cast again."""


def bodies_seen(
    rig: pe.Rig,
    vehicle: pe.Vehicle | None,
    bodies: Sequence[advice.StandingBody],
    model: pe.PerceptionModel,
) -> tuple[advice.BodySight, ...]:
    """Return what a rig sees of test bodies."""
    return advice.see_bodies(rig, vehicle, bodies, model, kernel_caches=_beams.made(vehicle, dict))


_layers: defaultdict[str, LayerCache] = defaultdict(LayerCache)
"""By lane: no two threads use the same one."""


def layer_shapes(
    request: ViewRequest, layer: str, rough: bool, names: Sequence[str]
) -> Generator[list[graphics.LayerShape] | None, None, list[graphics.LayerShape]]:
    """Return the shapes of a layer by these names; approximate ones where `rough`. Pause where a
    shape does; yield all of them where the last one has something for the time being."""
    row = next(each for each in LAYERS if each.name == layer)
    request = replace(request, moving=rough)
    shapes = list[graphics.LayerShape]()
    for name in names:
        shape = row.shape(request, _layers[row.lane], name)
        if isinstance(shape, Generator):
            shape = yield from _paused(shape, shapes, is_last=name == names[-1])
        shapes.append(shape)
    return shapes


def _paused(
    steps: ShapeSteps, made: Sequence[graphics.LayerShape], *, is_last: bool
) -> Generator[list[graphics.LayerShape] | None, None, graphics.LayerShape]:
    """Return the shape of some steps; pause where these do."""
    while True:
        try:
            early = next(steps)
        except StopIteration as end:
            shape: graphics.LayerShape = end.value
            return shape
        yield [*made, early] if is_last and early is not None else None


def clear() -> None:
    """Drop all that is kept: where the engine has no process, another file is opened."""
    _layers.clear()
    _sight.clear()
    _beams.clear()
    engine_calls.clear()
