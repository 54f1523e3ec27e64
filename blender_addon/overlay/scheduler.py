"""Schedules layers that are out of date: the engine's process makes them again.

Handlers and signals note changes; a timer then reads the scene and requests the layers whose keys
have changed. Results are stored in `layer_cache.shown`, and the views are redrawn. Without a window
there is no timer, and `update` does everything at once.
"""

from collections.abc import Hashable, Iterator, Mapping

import bpy

from ..caches import sensor_cache
from ..engine import graphics, pe
from ..processes import analysis_calls, engine_process
from ..view import viewport
from .layer_cache import ShownLayer, shown, shown_of
from .layers import LAYERS, Layer
from .request import ViewRequest
from .snapshot import SnapshotReader

DELAY_S = 0.01
BATCH_S = 0.12
"""How long a finished layer waits for others that were requested with it."""

_reader = SnapshotReader()
_requested: dict[tuple[str, str], tuple[Mapping[str, Hashable], bool]] = {}
"""The keys of the last request of each scene and layer: nothing is requested twice."""
_selection: dict[str, tuple[str, ...]] = {}
"""Selected sensors by the scene's name, at the last update."""
_moving = False


def update(moving: bool = False) -> None:
    """Request the layers that are out of date, in every scene that a window shows."""
    for scene, depsgraph in _scenes():
        request = _reader.request(scene, depsgraph, moving)
        for layer in LAYERS:
            _request(scene.name, layer, request)


def is_preview(scene: str, layer: str, name: str, item: ShownLayer) -> bool:
    """Whether a shown shape is approximate, or of before the last change."""
    keys, _ = _requested.get((scene, layer), ({name: item.key}, False))
    return item.rough or keys.get(name) != item.key


def schedule(*_: object) -> None:
    """Schedule an update; several calls become one update."""
    # Not without a window: a remaining timer makes Blender crash at its exit.
    if not bpy.app.background and not bpy.app.timers.is_registered(update_now):
        bpy.app.timers.register(update_now, first_interval=DELAY_S)


def on_moving() -> None:
    """Something moves: request approximate layers now."""
    global _moving
    _moving = True
    update(moving=True)


def on_live_score() -> None:
    """The baseline of the live score may have changed: difference maps have the same one. The best
    way of a moved sensor is requested once it has its score."""
    views = [scene.perception_entropy.view for scene in bpy.data.scenes]
    if any(view.ground_difference or view.show_steepest for view in views):
        schedule()


def on_idle() -> None:
    """The scene is idle: request exact layers."""
    global _moving
    _moving = False
    update()


def note_selection(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update: schedule one where other sensors are selected than before."""
    if bpy.app.background:
        return
    layer = depsgraph.view_layer
    active = layer.objects.active
    picked = tuple(
        each.name
        for each in sensor_cache.sensors(scene)
        if each == active or each.select_get(view_layer=layer)
    )
    if _selection.get(scene.name) != picked:
        _selection[scene.name] = picked
        schedule()


def clear(*_: object) -> None:
    """Drop everything that belongs to the file that was open."""
    for scene, layer in tuple(_requested):
        engine_process.drop(_topic(scene, layer))
    for each in (_requested, _selection, shown, _reader):
        each.clear()


def update_now() -> None:
    update(_moving)


def _scenes() -> Iterator[tuple[bpy.types.Scene, bpy.types.Depsgraph]]:
    """Yield the scenes that a window shows, evaluated as it shows them; each once."""
    shown_scenes = set()
    for window in bpy.context.window_manager.windows:
        if window.scene.name not in shown_scenes:
            shown_scenes.add(window.scene.name)
            with bpy.context.temp_override(window=window):
                yield window.scene, bpy.context.evaluated_depsgraph_get()
    if not shown_scenes:
        yield bpy.context.scene, bpy.context.evaluated_depsgraph_get()


def _request(scene: str, layer: Layer, request: ViewRequest) -> None:
    """Request one layer, if it is out of date."""
    keys = layer.keys(request) if layer.name in request.view.layers else {}
    if not keys:
        engine_process.drop(_topic(scene, layer.name))
        if _requested.pop((scene, layer.name), None) is not None:
            shown.pop((scene, layer.name), None)
            viewport.redraw_editors()
        return
    rough = request.moving and layer.rough
    have = shown_of(scene, layer.name)
    wanted = {
        name: item
        for name, item in have.items()
        if item.key == keys.get(name, item) and (rough or not item.rough)
    }
    if _requested.get((scene, layer.name)) == (keys, rough):
        return
    _, was_rough = _requested.get((scene, layer.name), ({}, rough))
    _requested[scene, layer.name] = keys, rough
    missing = [name for name in keys if name not in wanted]

    def show(shapes: list[graphics.LayerShape], is_rough: bool) -> None:
        made = dict(zip(missing, shapes, strict=True))
        items = {n: wanted.get(n) or ShownLayer(key, made[n], is_rough) for n, key in keys.items()}
        shown[scene, layer.name] = items

    def deliver(shapes: list[graphics.LayerShape]) -> None:
        show(shapes, rough)
        _redraw_together()

    def deliver_early(shapes: list[graphics.LayerShape] | None) -> None:
        if shapes is not None:
            show(shapes, True)
            viewport.redraw_editors()

    def fail(problem: Exception) -> None:
        shown.pop((scene, layer.name), None)
        viewport.redraw_editors()
        if not isinstance(problem, pe.InputError):  # a score reports what is wrong with the scene
            raise problem

    given = request, layer.name, rough, missing
    topic = _topic(scene, layer.name)
    if rough and not was_rough and layer.lane != engine_process.BEHIND:
        engine_process.drop(topic)  # the fine shape would keep the first rough one waiting
    engine_process.ask(
        topic,
        analysis_calls.layer_shapes,
        given,
        deliver,
        fail=fail,
        step=deliver_early,
        lane=layer.lane,
    )


def _redraw_together() -> None:
    """Redraw once for layers that finish one after the other: a frame may take longer than all of
    them. Late layers are not waited for."""
    if not any(engine_process.busy(_topic(*layer)) for layer in _requested):
        _redraw_now()
    elif not bpy.app.timers.is_registered(_redraw_now):
        bpy.app.timers.register(_redraw_now, first_interval=BATCH_S)


def _redraw_now() -> None:
    if bpy.app.timers.is_registered(_redraw_now):
        bpy.app.timers.unregister(_redraw_now)
    viewport.redraw_editors()


def _topic(scene: str, layer: str) -> str:
    return f"{engine_process.OVERLAY}{layer} of {scene}"


def register() -> None:
    """Show what there is."""
    schedule()


def unregister() -> None:
    """Cancel what is due, and drop everything."""
    for timer in (update_now, _redraw_now):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    clear()
    viewport.redraw_editors()
