"""Draws beams and frustums in the 3D view: the one owner of draw handle, batches and shaders."""

from __future__ import annotations

import bpy
import gpu
from bpy.app.handlers import persistent
from gpu_extras.batch import batch_for_shader

from .. import changes
from .cache import OverlayCache
from .geometry import OverlayGeometry, Primitives

LINE_WIDTH_PX = 1.2
VIEW = bpy.types.SpaceView3D

Batches = tuple[OverlayGeometry, gpu.types.GPUBatch | None, gpu.types.GPUBatch | None]

_cache = OverlayCache()
_batches: dict[str, Batches] = {}
_shaders: dict[str, gpu.types.GPUShader] = {}
_handles: list[object] = []


def register() -> None:
    """Start drawing; Blender draws every view once an add-on has been registered."""
    if not _handles:
        _handles.append(VIEW.draw_handler_add(draw, (), "WINDOW", "POST_VIEW"))
        for handlers, function in _handlers():
            handlers.append(function)
        for signal in (changes.study, changes.picture):
            signal.connect(tag_redraw)


def unregister() -> None:
    """Stop drawing, and leave nothing behind."""
    while _handles:
        for signal in (changes.study, changes.picture):
            signal.disconnect(tag_redraw)
        VIEW.draw_handler_remove(_handles.pop(), "WINDOW")
        for handlers, function in reversed(_handlers()):
            handlers.remove(function)
    forget()
    _shaders.clear()
    tag_redraw()


def tag_redraw() -> None:
    """Have every 3D view drawn anew."""
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()


@persistent
def forget(*_: object) -> None:
    """Drop everything that belongs to the file that was open."""
    _cache.clear()
    _batches.clear()


def _handlers() -> tuple[tuple[list, object], ...]:
    return ((bpy.app.handlers.load_post, forget),)


def draw() -> None:
    """Draw into the current 3D view; Blender calls this at each redraw."""
    context = bpy.context
    if not (context.scene.perception_entropy.show_overlay and _wanted(context.space_data)):
        return
    shown = _cache.update(context.scene, context.evaluated_depsgraph_get())
    _update_batches(shown)
    names = [name for name in shown if _visible(context, name)]
    draw_batches([_batches[name] for name in names], context.region)


def draw_batches(batches: list[Batches], region: bpy.types.Region) -> None:
    """Draw faces, then lines, hidden behind what is nearer; the GPU's state is put back."""
    blend, depth_test = gpu.state.blend_get(), gpu.state.depth_test_get()
    depth_mask = gpu.state.depth_mask_get()
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(False)
    try:
        for _, _, faces in batches:
            if faces is not None:
                faces.draw(_shader("SMOOTH_COLOR"))
        for _, lines, _ in batches:
            if lines is not None:
                lines.draw(_line_shader(region))
    finally:
        gpu.state.depth_mask_set(depth_mask)
        gpu.state.depth_test_set(depth_test)
        gpu.state.blend_set(blend)


def _wanted(space: bpy.types.Space | None) -> bool:
    """Whether the view shows overlays at all."""
    return space is None or space.type != "VIEW_3D" or space.overlay.show_overlays


def _visible(context: bpy.types.Context, name: str) -> bool:
    """Whether the view shows that sensor: not hidden, and in local view when there is one."""
    sensor = context.scene.objects.get(name)
    if sensor is None:
        return False
    space = context.space_data
    return sensor.visible_in_viewport_get(space) if space else sensor.visible_get()


def _update_batches(shown: dict[str, OverlayGeometry]) -> None:
    """Upload what is new, drop what is gone."""
    for name in set(_batches) - set(shown):
        del _batches[name]
    for name, geometry in shown.items():
        if name not in _batches or _batches[name][0] is not geometry:
            lines = _batch(_shader("POLYLINE_SMOOTH_COLOR"), "LINES", geometry.lines)
            faces = _batch(_shader("SMOOTH_COLOR"), "TRIS", geometry.faces)
            _batches[name] = geometry, lines, faces


def _batch(
    shader: gpu.types.GPUShader, kind: str, primitives: Primitives
) -> gpu.types.GPUBatch | None:
    if not len(primitives.points):
        return None
    arrays = {"pos": primitives.points, "color": primitives.colors}
    return batch_for_shader(shader, kind, arrays)


def _shader(name: str) -> gpu.types.GPUShader:
    """Return a built-in shader; made when first drawn, as there is no GPU in background."""
    if name not in _shaders:
        _shaders[name] = gpu.shader.from_builtin(name)
    return _shaders[name]


def _line_shader(region: bpy.types.Region) -> gpu.types.GPUShader:
    shader = _shader("POLYLINE_SMOOTH_COLOR")
    shader.bind()
    shader.uniform_float("viewportSize", (region.width, region.height))
    width = LINE_WIDTH_PX * bpy.context.preferences.system.pixel_size
    shader.uniform_float("lineWidth", width)
    return shader
