"""Draws ground, road and sky round a sensor whose picture is shown: see `graphics.surroundings`.

They are drawn over the view of a scene, hidden by what is nearer: by the surroundings that the
scene has (`operators.surroundings`), too.
"""

import gpu

from ..engine import graphics, pe, text
from ..view.viewport import DrawRegion
from .batches import Batches

MAX_EYES = 16
"""Places whose surroundings are kept on the graphics card."""
LINE_PX = 1.0
_kept: text.RecentCache[Batches] = text.RecentCache(MAX_EYES)


def clear() -> None:
    """Keep nothing."""
    _kept.clear()


def draw_around(eye: pe.Pose, area: DrawRegion, as_linear: bool = False) -> None:
    """Draw what is around a sensor, with the matrices of its picture.

    `as_linear`: into a texture of linear light.
    """
    x, y = eye.position[:2]

    def make() -> Batches:
        shape = graphics.surroundings(x, y)
        for part in (shape.faces, shape.thin) if as_linear else ():
            part.colors[:] = graphics.linear(part.colors)
        return Batches.of(shape)

    batches = _kept.made((x, y, as_linear), make)
    before = gpu.state.blend_get(), gpu.state.depth_test_get(), gpu.state.depth_mask_get()
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(False)
    try:
        batches.draw_areas()
        batches.draw_lines(area, LINE_PX, edged=False)
    finally:
        gpu.state.depth_mask_set(before[2])
        gpu.state.depth_test_set(before[1])
        gpu.state.blend_set(before[0])
