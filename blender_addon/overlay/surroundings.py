"""Draws a road and test bodies around a sensor whose picture is shown: see `graphics.surroundings`.

They are drawn over the view of a scene, hidden by what is nearer. The scene has no object of them:
nothing of it is scored, exported or rendered.
"""

from typing import TYPE_CHECKING

import gpu

from .. import vehicle_cache
from ..engine import graphics, pe, text
from ..viewport import DrawRegion
from .batches import Batches

if TYPE_CHECKING:
    import bpy


MAX_EYES = 4  # Poses whose surroundings are kept on the graphics card
LINE_PX = 1.0
_kept: text.RecentCache[tuple[graphics.Surroundings, Batches, Batches]] = text.RecentCache(MAX_EYES)


def clear() -> None:
    """Keep nothing."""
    _kept.clear()


def labels_around(scene: "bpy.types.Scene", eye: pe.Pose) -> tuple[graphics.Tag, ...]:
    """Return the names and distances of the test bodies around a sensor."""
    return _around(scene, eye)[0].bodies.labels


def draw_around(
    scene: "bpy.types.Scene", eye: pe.Pose, area: DrawRegion, as_linear: bool = False
) -> None:
    """Draw what is around a sensor, with the matrices of its picture. `as_linear`: into a texture
    of linear light."""
    _, ground, bodies = _around(scene, eye, as_linear)
    before = gpu.state.blend_get(), gpu.state.depth_test_get(), gpu.state.depth_mask_get()
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    try:
        for batches, hides in ((ground, False), (bodies, True)):
            gpu.state.depth_mask_set(hides)
            batches.draw_areas()
            gpu.state.depth_mask_set(False)
            batches.draw_lines(area, LINE_PX, edged=False)
    finally:
        gpu.state.depth_mask_set(before[2])
        gpu.state.depth_test_set(before[1])
        gpu.state.blend_set(before[0])


def _around(
    scene: "bpy.types.Scene", eye: pe.Pose, as_linear: bool = False
) -> tuple[graphics.Surroundings, Batches, Batches]:
    vehicle = vehicle_cache.shared.last_read(scene.name)

    def make() -> tuple[graphics.Surroundings, Batches, Batches]:
        made = graphics.surroundings(eye, None if vehicle is None else vehicle.bounds)
        for shape in (made.ground, made.bodies) if as_linear else ():
            for part in (shape.faces, shape.thin):
                part.colors[:] = graphics.linear(part.colors)
        return made, Batches.of(made.ground), Batches.of(made.bodies)

    return _kept.made((eye, id(vehicle), as_linear), make)
