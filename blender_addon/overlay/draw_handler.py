"""Draws the shown layers in the 3D view: the one owner of the overlay's draw handles and batches.

Nothing is read, cast or computed here: a redraw takes what is ready.
"""

import contextlib
from collections.abc import Iterator, Sequence
from dataclasses import replace

import bpy
import gpu
import numpy as np
from mathutils import Matrix

from .. import document
from ..caches import vehicle_cache
from ..engine import graphics, pe
from ..panel_text import is_simple, plain
from ..processes import engine_process
from ..queries import body_query
from ..view import plates, viewport
from . import labels, scheduler, strip, surroundings, wipe
from .batches import Batches
from .layer_cache import shown_of
from .layers import LAYERS, OTHER_RIG, WHOLE_RIG, Layer

OFFSET_SHARE = 0.002
"""Share of its distance from the eye by which a thing is drawn nearer."""
OUT_OF_DATE = "out of date"
OFFSET_M = 0.02
"""The same in a view without perspective, which has no eye [m]."""


@contextlib.contextmanager
def depth_offset(look: bpy.types.RegionView3D | None, wanted: bool) -> Iterator[None]:
    """Context manager: draw nearer to the eye, at the same position in the picture."""
    if not wanted or look is None:
        yield
        return
    gpu.matrix.push()
    try:
        gpu.matrix.multiply_matrix(offset_matrix(look.view_matrix, look.is_perspective))
        yield
    finally:
        gpu.matrix.pop()


def offset_matrix(view_from_world: Matrix, perspective: bool) -> Matrix:
    """Return the matrix, world to world: towards the eye, or towards the viewer without an eye."""
    world_from_view = view_from_world.inverted()
    if not perspective:
        return Matrix.Translation(world_from_view.col[2].to_3d() * OFFSET_M)
    eye = world_from_view.translation
    return Matrix.Translation(eye) @ Matrix.Scale(1.0 - OFFSET_SHARE, 4) @ Matrix.Translation(-eye)


ShownName = tuple[str, str]  # Of a layer, and of a sensor or of the whole rig
_batches: dict[tuple[str, str, str], Batches] = {}
"""By scene, layer and sensor."""
_handlers = viewport.DrawHandlers()


def register() -> None:
    """Start drawing; Blender draws every view once an add-on has been registered."""
    if not _handlers.shown:
        _handlers.show((draw, "POST_VIEW"), (draw_text, "POST_PIXEL"))
        scheduler.register()


def unregister() -> None:
    """Stop drawing, and release everything."""
    if _handlers.shown:
        scheduler.unregister()
    _handlers.hide()
    clear()
    viewport.release_plates()
    viewport.release_gpu()


def clear(*_: object) -> None:
    """Drop everything that belongs to the file that was open."""
    _batches.clear()
    strip.clear()
    surroundings.clear()


def draw() -> None:
    """Draw areas and lines into the current 3D view; Blender calls this at each redraw."""
    context = bpy.context
    engine_process.deliver_for_view()  # before all that is drawn: Blender ignores a tag meanwhile
    if not _overlays_shown(context):
        return
    scene = context.scene.name
    eye = _eye(context)
    if eye is not None:
        surroundings.draw_around(eye, context.region)
    now = _seconds(context.scene)
    wanted = [
        (layer, _by_side(context, names, uploaded(scene, layer, names, now)))
        for layer, names in _visible(context)
    ]
    for key in [k for k in _batches if k[0] == scene and k[2] not in shown_of(*k[:2])]:
        del _batches[key]
    before = gpu.state.blend_get(), gpu.state.depth_test_get(), gpu.state.depth_mask_get()
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(False)
    try:
        for layer, sides in wanted:
            for clip, several in sides:
                with depth_offset(context.region_data, layer.on_ground), clip:
                    for each in several:
                        each.draw_areas()
                    for each in several:
                        each.draw_lines(context.region, layer.line_px, edged=layer.edged)
    finally:
        gpu.state.depth_mask_set(before[2])
        gpu.state.depth_test_set(before[1])
        gpu.state.blend_set(before[0])


def _by_side(
    context: bpy.types.Context, names: list[str], several: list[Batches]
) -> list[tuple[contextlib.AbstractContextManager[None], list[Batches]]]:
    """Return batches of a layer, and where they are drawn: those of two variants on two sides."""
    if OTHER_RIG not in names:
        return [(contextlib.nullcontext(), several)]
    line = wipe.line_px(context)
    return [
        (wipe.clipped(context.region, line, name), [each])
        for name, each in zip(names, several, strict=True)
    ]


def draw_text() -> None:
    """Draw plates and labels over the current 3D view; Blender calls this at each redraw."""
    context = bpy.context
    scene = context.scene
    is_shown = _overlays_shown(context)
    visible: list[ShownName] = []
    if is_shown:
        visible = [(layer.name, name) for layer, names in _visible(context) for name in names]
    line = 0.0
    names_of_both: list[viewport.PlateBox] = []
    if any(name == OTHER_RIG for _, name in visible):
        line = wipe.line_px(context)
        names_of_both = wipe.draw_line(context, line, _names_of_both(scene))
    vehicle = vehicle_cache.shared.last_read(scene.name)
    taken = plates.draw(
        context,
        lambda context, room: plates_of(context, visible, room),
        vehicle=None if vehicle is None or _eye(context) is not None else vehicle.bounds,
        taken=names_of_both,
    )
    if not is_shown:
        return
    written = _labels_of(context, visible, line)
    if is_simple(scene):
        written = [replace(tag, text=plain(tag.text)) for tag in written]
    labels.draw_labels(context, written, taken)


def _labels_of(
    context: bpy.types.Context, visible: Sequence[ShownName], line: float
) -> list[graphics.Tag]:
    """Return the labels of what is visible; those of two variants on their side of the line."""
    scene = context.scene
    now = _seconds(scene)
    wiped = {layer for layer, name in visible if name == OTHER_RIG}
    found: list[graphics.Tag] = []
    if scene.perception_entropy.view.show_bodies:
        found += body_query.labels(scene, context.active_object)
    for layer, name in visible:
        tags = shown_of(scene.name, layer)[name].shape.at(now).labels
        found += wipe.on_side(context, tags, line, name) if layer in wiped else tags
    return found


def plates_of(
    context: bpy.types.Context, visible: Sequence[ShownName], room: plates.Room
) -> list[plates.Plate]:
    """Return the strips of drive-bys and the legends of what is visible."""
    scene = context.scene
    found = []
    for layer, name in visible:
        item = shown_of(scene.name, layer)[name]
        below = getattr(item.shape, "strip", None)
        if below is not None and viewport.is_lower_left(context):
            note = OUT_OF_DATE if scheduler.is_preview(scene.name, layer, name, item) else ""
            found.append(strip.strip_plate(below, room, seconds=_seconds(scene), note=note))
    return [*found, *labels.legend_plates(_legends(context, visible), room)]


def _legends(context: bpy.types.Context, visible: Sequence[ShownName]) -> list[graphics.ColorKey]:
    """Return the legends of what is visible, each once; in a quad view, of the one that turns."""
    scene = context.scene
    space = context.space_data
    is_fixed = space and len(space.region_quadviews) and context.region_data != space.region_3d
    if is_fixed or not scene.perception_entropy.view.show_legend:
        return []
    found = (legend_of(scene.name, layer, name) for layer, name in visible)
    legends = list(dict.fromkeys(each for each in found if each is not None))
    if is_simple(scene):
        legends = [
            replace(k, title=plain(k.title), values=(*map(plain, k.values),)) for k in legends
        ]
    return legends


def _names_of_both(scene: bpy.types.Scene) -> tuple[str, str]:
    """Return the name of the ghost variant, and that of what is in the scene."""
    settings = scene.perception_entropy
    names = {row.key: row.name for row in settings.variants}
    here = names.get(settings.variant_key, "")
    changed = f"{here} (changed)" if here and settings.variant_changed else here
    return names.get(settings.view.ghost_key, ""), changed or "Present sensors"


def legend_of(scene: str, layer: str, name: str) -> graphics.ColorKey | None:
    """Return the legend of a shape, marked where it is a preview and does not say so itself."""
    item = shown_of(scene, layer)[name]
    found = item.shape.at(0.0).legend
    if name == OTHER_RIG and found not in (None, legend_of(scene, layer, WHOLE_RIG)):
        variant = _names_of_both(bpy.data.scenes[scene])[0]
        found = replace(found, title=f"{found.title}, {variant}")
    if found is None or "preview" in found.title:
        return found
    if not scheduler.is_preview(scene, layer, name, item):
        return found
    return replace(found, title=f"{found.title} (preview)")


def _seconds(scene: bpy.types.Scene) -> float:
    """Return how long after the first frame of a scene its present one is [s]."""
    return (scene.frame_current - scene.frame_start) / document.frame_rate(scene)


def uploaded(scene: str, layer: Layer, names: list[str], seconds: float = 0.0) -> list[Batches]:
    """Return the batches of a layer at a time after the first frame; upload new shapes."""
    found = []
    for name in names:
        shape = shown_of(scene, layer.name)[name].shape.at(seconds)
        known = _batches.get((scene, layer.name, name))
        if known is None or known.shape is not shape:
            known = _batches[scene, layer.name, name] = Batches.of(shape)
        found.append(known)
    return found


def _overlays_shown(context: bpy.types.Context) -> bool:
    """Whether the view shows overlays at all."""
    if not context.scene.perception_entropy.show_overlay:
        return False
    space = context.space_data
    return space is None or space.type != "VIEW_3D" or space.overlay.show_overlays


def _visible(context: bpy.types.Context) -> Iterator[tuple[Layer, list[str]]]:
    """Yield the layers, each with the names of the sensors that the view shows."""
    scene = context.scene.name
    through = _sensor_looked_through(context)
    space = context.space_data
    # In a local view there is no layer of the whole rig.
    is_whole = not (space and space.type == "VIEW_3D" and space.local_view)
    known = {WHOLE_RIG: is_whole, OTHER_RIG: is_whole}
    for layer in LAYERS:
        names = list(shown_of(scene, layer.name))
        for name in names:
            if name not in known:
                known[name] = name != through and _sensor_visible(context, name)
        yield layer, [name for name in names if known[name]]


def _sensor_visible(context: bpy.types.Context, name: str) -> bool:
    """Whether the view shows that sensor: not hidden, and in local view when there is one."""
    sensor = context.scene.objects.get(name)
    if sensor is None:
        return False
    space = context.space_data
    return sensor.visible_in_viewport_get(space) if space else sensor.visible_get()


def _sensor_looked_through(context: bpy.types.Context) -> str | None:
    """Return the sensor that the view looks through: its own layers would be in the way."""
    look = context.region_data
    space = context.space_data
    if look is None or space is None or look.view_perspective != "CAMERA":
        return None
    eye = space.camera
    while eye is not None and not eye.perception_entropy.is_sensor:
        eye = eye.parent
    return None if eye is None else eye.name


def _eye(context: bpy.types.Context) -> pe.Pose | None:
    """Return the pose of the sensor that the view looks through."""
    name = _sensor_looked_through(context)
    sensor = context.scene.objects.get(name) if name else None
    return None if sensor is None else document.pose_of_matrix(np.array(sensor.matrix_world))
