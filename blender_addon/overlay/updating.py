"""Has what is shown worked out anew when something changed, beside the window.

Whatever changes is noted by handlers and signals; a timer then reads the scene and asks the worker
for the layers that are no longer what they should be. What comes back is put into the store, and
the views are drawn again. Without a window nothing comes by itself, and `update` does all at once.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import replace

import bpy
from bpy.app.handlers import persistent

from .. import changes, redraw, roster, worker
from ..engine import pe
from .layers import LAYERS, Layer
from .reading import SceneReader
from .store import ShownLayer, shown
from .tools import Tools
from .wish import PictureWish

SOON_S = 0.01
TOGETHER_S = 0.12
"""How long a layer that is ready waits for others that were asked for with it."""

_reader = SceneReader()
_tools = Tools()
_asked: dict[tuple[str, str], tuple[Mapping[str, Hashable], bool]] = {}
"""What was asked for last in each scene and layer: nothing is asked for twice."""
_selection: dict[str, tuple[str, ...]] = {}
"""Selected sensors by the scene's name, as they were when last looked at."""
_moving = False


def update(moving: bool = False) -> None:
    """Ask for all that is not as it should be, in every scene that a window shows."""
    for scene, depsgraph in _scenes():
        wish = _reader.wish(scene, depsgraph, moving)
        for layer in LAYERS:
            _ask(scene.name, layer, wish)


def is_preview(scene: str, layer: str, name: str, item: ShownLayer) -> bool:
    """Whether what is shown is coarser than at rest, or of before the last change."""
    keys, _ = _asked.get((scene, layer), ({name: item.key}, False))
    return item.rough or keys.get(name) != item.key


def soon(*_: object) -> None:
    """Update in a moment; several wishes become one."""
    # Without a window nobody looks, and a timer left behind makes Blender crash at its exit.
    if not bpy.app.background and not bpy.app.timers.is_registered(_turn):
        bpy.app.timers.register(_turn, first_interval=SOON_S)


def on_moved() -> None:
    """Something moves: a rough picture now."""
    global _moving
    _moving = True
    update(moving=True)


def on_reading() -> None:
    """The live score may be compared with other sensors now: difference maps are of the same."""
    if any(scene.perception_entropy.view.ground_difference for scene in bpy.data.scenes):
        soon()


def on_rested() -> None:
    """It rests: the fine picture."""
    global _moving
    _moving = False
    update()


@persistent
def note_selection(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update: notice when other sensors are selected than before."""
    if bpy.app.background:
        return
    layer = depsgraph.view_layer
    active = layer.objects.active
    picked = tuple(
        each.name
        for each in roster.sensors(scene)
        if each == active or each.select_get(view_layer=layer)
    )
    if _selection.get(scene.name) != picked:
        _selection[scene.name] = picked
        soon()


@persistent
def forget(*_: object) -> None:
    """Drop everything that belongs to the file that was open."""
    for scene, layer in tuple(_asked):
        worker.desk.drop(_topic(scene, layer))
    for each in (_asked, _selection, shown, _reader):
        each.clear()
    global _tools
    _tools = Tools()  # work under way keeps the old ones to itself


def _turn() -> None:
    update(_moving)


def _scenes() -> Iterator[tuple[bpy.types.Scene, bpy.types.Depsgraph]]:
    """Scenes that a window shows, evaluated as it shows them; each once."""
    known = set()
    for window in bpy.context.window_manager.windows:
        if window.scene.name not in known:
            known.add(window.scene.name)
            with bpy.context.temp_override(window=window):
                yield window.scene, bpy.context.evaluated_depsgraph_get()
    if not known:
        yield bpy.context.scene, bpy.context.evaluated_depsgraph_get()


def _ask(scene: str, layer: Layer, wish: PictureWish) -> None:
    """Have one layer worked out, if it is not what it should be."""
    keys = layer.keys(wish) if layer.name in wish.view.layers else {}
    if not keys:
        worker.desk.drop(_topic(scene, layer.name))
        if _asked.pop((scene, layer.name), None) is not None:
            shown.drop(scene, layer.name)
            redraw.editors()
        return
    rough = wish.moving and layer.rough
    have = shown.items(scene, layer.name)
    wanted = {name: _enough(have.get(name), key, rough) for name, key in keys.items()}
    if _asked.get((scene, layer.name)) == (keys, rough):
        return
    _asked[scene, layer.name] = keys, rough
    worker.desk.ask(
        _topic(scene, layer.name),
        lambda: _worked_out(layer, replace(wish, moving=rough), keys, wanted, _tools),
        _delivery(scene, layer.name),
        _failure(scene, layer.name),
    )


def _enough(item: ShownLayer | None, key: Hashable, rough: bool) -> ShownLayer | None:
    """Return what is shown already, if it will do."""
    return item if item is not None and item.key == key and (rough or not item.rough) else None


def _worked_out(
    layer: Layer,
    wish: PictureWish,
    keys: Mapping[str, Hashable],
    have: Mapping[str, ShownLayer | None],
    tools: Tools,
) -> dict[str, ShownLayer]:
    """Work on the thread: shapes by name; those that will do stay the same objects."""
    rough = wish.moving
    return {
        name: have[name] or ShownLayer(key, layer.shape(wish, tools, name), rough)
        for name, key in keys.items()
    }


def _delivery(scene: str, layer: str) -> Callable[[dict[str, ShownLayer]], None]:
    def deliver(items: dict[str, ShownLayer]) -> None:
        shown.put(scene, layer, items)
        _draw_together()

    return deliver


def _draw_together() -> None:
    """Have views drawn once for layers that come one after the other: a frame may take longer than
    all of them. Those that are late are not waited for."""
    if not any(worker.desk.busy(_topic(*asked)) for asked in _asked):
        _draw_now()
    elif not bpy.app.timers.is_registered(_draw_now):
        bpy.app.timers.register(_draw_now, first_interval=TOGETHER_S)


def _draw_now() -> None:
    if bpy.app.timers.is_registered(_draw_now):
        bpy.app.timers.unregister(_draw_now)
    redraw.editors()


def _failure(scene: str, layer: str) -> Callable[[Exception], None]:
    def fail(problem: Exception) -> None:
        shown.drop(scene, layer)
        redraw.editors()
        if not isinstance(problem, pe.InputError):  # a score says what is wrong with the scene
            raise problem

    return fail


def _topic(scene: str, layer: str) -> str:
    return f"overlay {layer} of {scene}"


def _handlers() -> tuple[tuple[list, object], ...]:
    lists = bpy.app.handlers
    return (
        (lists.depsgraph_update_post, note_selection),
        (lists.load_pre, forget),
        (lists.load_post, forget),
        (lists.load_post, soon_after_load),
    )


@persistent
def soon_after_load(*_: object) -> None:
    """Another file is open: show what it has."""
    soon()


def _signals() -> tuple[tuple[changes.Signal, Callable[[], None]], ...]:
    return (
        (changes.study, soon),
        (changes.picture, soon),
        (changes.moved, on_moved),
        (changes.rested, on_rested),
        (changes.reading, on_reading),
    )


def register() -> None:
    """Start listening; show what is there."""
    for handlers, function in _handlers():
        if function not in handlers:
            handlers.append(function)
    for signal, function in _signals():
        signal.connect(function)
    soon()


def unregister() -> None:
    """Stop listening, and forget everything."""
    for signal, function in _signals():
        signal.disconnect(function)
    for handlers, function in reversed(_handlers()):
        if function in handlers:
            handlers.remove(function)
    for timer in (_turn, _draw_now):
        if bpy.app.timers.is_registered(timer):
            bpy.app.timers.unregister(timer)
    forget()
    redraw.editors()
