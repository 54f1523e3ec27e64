"""What all drawers in 3D views share: handlers, text and plates in corners, redraw.

The live score, pictures of cameras, legends and labels are written by the functions
of this module, in pixels of a region. Where plates go is laid out by `plates`; their boxes are
plain numbers by region; no object of Blender's is held.
"""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from typing import Protocol

import blf
import bpy
import gpu
from gpu_extras.batch import batch_for_shader

from ..panel_text import typeset

Rgba = tuple[float, float, float, float]
PlateBox = tuple[float, float, float, float]
"""Left, bottom, right, top in the region [px]."""

VIEW = bpy.types.SpaceView3D
FONT = 0
SMALL = 11.0
"""Size of most text, in pixels of an interface at scale 1; so are all lengths of drawers."""
MARGIN = 14.0
HUD_ROW = 30.0
"""From the toolbar to a plate, and the height of the panel of the last operation."""
HEADER = 110.0
"""Height of the headers and of Blender's own text, from the top."""
INK: Rgba = (0.95, 0.95, 0.95, 1.0)
FAINT: Rgba = (0.74, 0.74, 0.74, 1.0)
PLATE: Rgba = (0.08, 0.08, 0.08, 0.84)
"""Below all text. It hides so much of what is behind it that text can be read over white, too."""
MIN_CONTRAST = 4.5
"""Of text and what is behind it: WCAG 2.2, 1.4.3, level AA."""
LIGHTER = 0.05

ELLIPSIS = "\N{HORIZONTAL ELLIPSIS}"

_shaders: dict[str, gpu.types.GPUShader] = {}
_square: list[gpu.types.GPUBatch] = []
_gradients: dict[tuple[Rgba, ...], gpu.types.GPUBatch] = {}
"""Uploaded once, in the unit square, and drawn at any place and size."""
_plates: dict[int, tuple[tuple[int, PlateBox], ...]] = {}
"""Kinds and boxes of the plates that were drawn last, by the region's pointer."""


def redraw_editors() -> None:
    """Have every 3D view redrawn, in every window."""
    for manager in bpy.data.window_managers:
        for window in manager.windows:
            for area in window.screen.areas:
                if area.type == "VIEW_3D":
                    area.tag_redraw()


def redraw_soon() -> None:
    """Have every 3D view and its sidebar redrawn after the present redraw: during it Blender
    ignores a tag of the region that is drawn."""
    if not bpy.app.background and not bpy.app.timers.is_registered(redraw_editors):
        bpy.app.timers.register(redraw_editors, first_interval=0.0)


def shader(name: str) -> gpu.types.GPUShader:
    """Return a built-in shader; made when first drawn, as there is no GPU in background."""
    if name not in _shaders:
        _shaders[name] = gpu.shader.from_builtin(name)
    return _shaders[name]


class DrawRegion(Protocol):
    """What is drawn into: its size [px]."""

    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...


def line_shader(name: str, region: DrawRegion, width_px: float) -> gpu.types.GPUShader:
    """Return a shader of lines, bound, for a width in a region."""
    wide = shader(name)
    wide.bind()
    wide.uniform_float("viewportSize", (region.width, region.height))
    wide.uniform_float("lineWidth", width_px)
    return wide


def release_gpu() -> None:
    """Keep nothing on the graphics card."""
    _shaders.clear()
    _square.clear()
    _gradients.clear()


def text_size(text: str, size_px: float) -> tuple[float, float]:
    """Return the width and height of a line of text as it is drawn [px]."""
    return _size_in(bpy.context.preferences.view.font_path_ui, text, size_px)


@lru_cache(maxsize=1024)
def _size_in(_font_path: str, text: str, size_px: float) -> tuple[float, float]:
    blf.size(FONT, size_px)
    width, height = blf.dimensions(FONT, typeset(text))
    return width, height


def fitted(text: str, size_px: float, widest: float) -> str:
    """Return a text as much of which as a width has room for [px]: its end is left out."""
    if text_size(text, size_px)[0] <= widest:
        return text
    shorter = (text[:end].rstrip() + ELLIPSIS for end in range(len(text) - 1, 0, -1))
    return next((each for each in shorter if text_size(each, size_px)[0] <= widest), "")


def luminance(color: Sequence[float]) -> float:
    """Return the relative luminance of an sRGB colour, 0 to 1 (WCAG 2.2)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in color[:3]]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: Sequence[float], other: Sequence[float]) -> float:
    """Return the contrast of two sRGB colours, 1 to 21 (WCAG 2.2)."""
    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)


def over(color: Rgba, behind: Sequence[float]) -> tuple[float, ...]:
    """Return how a colour looks over an opaque one."""
    share = color[3]
    return tuple(share * c + (1.0 - share) * b for c, b in zip(color, behind, strict=False))


BRIGHTEST = over(PLATE, (1.0, 1.0, 1.0))
"""A plate over white: the worst that text is read on."""


@lru_cache(maxsize=256)
def readable(color: Rgba) -> Rgba:
    """Return the colour of text on a plate: opaque, and so much lighter as its contrast needs."""
    share = 0.0
    lighter: Rgba = (*color[:3], 1.0)
    while contrast(lighter, BRIGHTEST) < MIN_CONTRAST and share < 1.0:
        share += LIGHTER
        red, green, blue = (c + share * (1.0 - c) for c in color[:3])
        lighter = (red, green, blue, 1.0)
    return lighter


def draw_text(
    text: str, x: float, y: float, size_px: float, color: Rgba, *, left_of_x: float = 0.0
) -> float:
    """Draw a line of text on a baseline; return its width [px].
    `left_of_x` is the share of the text that lies left of `x`: 0 begins there, 1 ends there."""
    width, _ = text_size(text, size_px)
    blf.size(FONT, size_px)
    blf.color(FONT, *readable(color))
    blf.position(FONT, round(x - left_of_x * width), round(y), 0.0)
    blf.draw(FONT, typeset(text))
    return width


def fill_box(box: PlateBox, color: Rgba) -> None:
    """Fill a box, mixed with what is below it."""
    plain = shader("UNIFORM_COLOR")
    if not _square:
        corners = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0))
        _square.append(batch_for_shader(plain, "TRI_FAN", {"pos": corners}))
    plain.uniform_float("color", color)
    with blended(), in_box(box):
        _square[0].draw(plain)


def fill_gradient(box: PlateBox, colors: Sequence[Rgba]) -> None:
    """Fill a box with a row of colours that run into each other, from left to right."""
    smooth = shader("SMOOTH_COLOR")
    row = tuple(colors)
    if row not in _gradients:
        corners = [(i / (len(row) - 1), y, 0.0) for i in range(len(row)) for y in (0.0, 1.0)]
        shades = [color for color in row for _ in range(2)]
        _gradients[row] = batch_for_shader(smooth, "TRI_STRIP", {"pos": corners, "color": shades})
    with blended(), in_box(box):
        _gradients[row].draw(smooth)


def draw_outline(box: PlateBox, color: Rgba) -> None:
    """Draw the edges of a box, a pixel wide."""
    left, bottom, right, top = box
    edges = ((left, bottom), (right, bottom), (right, top), (left, top), (left, bottom))
    plain = shader("UNIFORM_COLOR")
    plain.uniform_float("color", color)
    batch = batch_for_shader(plain, "LINE_STRIP", {"pos": [(x, y, 0.0) for x, y in edges]})
    with blended():
        batch.draw(plain)


@contextlib.contextmanager
def blended() -> Iterator[None]:
    """Mix colours with what is there, within; the blend mode of before comes back."""
    before = gpu.state.blend_get()
    gpu.state.blend_set("ALPHA")
    try:
        yield
    finally:
        gpu.state.blend_set(before)


@contextlib.contextmanager
def in_box(box: PlateBox) -> Iterator[None]:
    """Have what is drawn in the unit square fill a box [px], within."""
    left, bottom, right, top = box
    with gpu.matrix.push_pop():
        gpu.matrix.translate((left, bottom, 0.0))
        gpu.matrix.scale((right - left, top - bottom, 1.0))
        yield


class DrawHandlers:
    """Functions that draw in all 3D views while they are shown: the one owner of their handles."""

    def __init__(self) -> None:
        self._handles: list[object] = []

    @property
    def shown(self) -> bool:
        """Whether the functions draw."""
        return bool(self._handles)

    def show(self, *functions: tuple[Callable[[], None], str]) -> None:
        """Start drawing with functions, each at "POST_VIEW" (in space) or "POST_PIXEL"."""
        if not self._handles:
            for function, when in functions:
                handle = VIEW.draw_handler_add(function, (), "WINDOW", when)
                self._handles.append(handle)

    def hide(self) -> None:
        """Stop drawing; do nothing if it has stopped."""
        while self._handles:
            VIEW.draw_handler_remove(self._handles.pop(), "WINDOW")


def ui_scale() -> float:
    """Return the scale of Blender's interface."""
    return bpy.context.preferences.system.ui_scale


def is_lower_left(context: bpy.types.Context) -> bool:
    """Whether the region is the lower left one of its area: of four in a quad view, one."""
    windows = [region for region in context.area.regions if region.type == "WINDOW"]
    return context.region == min(windows, key=lambda region: (region.y, region.x))


def toolbar_right(context: bpy.types.Context) -> float:
    """Return where the toolbar ends that lies over the left part of a view [px]."""
    region = context.region
    left = 0.0
    for other in context.area.regions:
        if other.type == "TOOLS" and other.x < region.x + region.width / 2:
            left = max(left, other.x + other.width - region.x)
    return left


def beside_toolbar(context: bpy.types.Context) -> float:
    """Return where a plate in the lower left corner begins, from the left: clear of the toolbar."""
    return toolbar_right(context) + MARGIN * ui_scale()


def sidebar_left(context: bpy.types.Context) -> float:
    """Return where the sidebar begins that lies over the right part of a view [px]."""
    over = context.preferences.system.use_region_overlap
    widths = (r.width for r in context.area.regions if over and r.type == "UI" and r.width > 1)
    return context.region.width - max(widths, default=0)


def above_hud(context: bpy.types.Context) -> float:
    """Return where a plate begins, from below: clear of the panel of the last operation. A row is
    always left for that panel, so that the plate does not jump with every move."""
    bottom = HUD_ROW * ui_scale()
    for other in context.area.regions:
        if other.type == "HUD" and other.height > 1:
            bottom = max(bottom, other.y + other.height - context.region.y)
    return bottom + MARGIN * ui_scale() / 2.0


def note_plates(region: int, plates: Sequence[tuple[int, PlateBox]]) -> None:
    """Note kind and box of the plates that are drawn in a region, by the region's pointer."""
    _plates[region] = tuple(plates)


def release_plates() -> None:
    """Forget the boxes of plates in all regions."""
    _plates.clear()


def plate_boxes(region: int, of_kind: int | None = None) -> tuple[PlateBox, ...]:
    """Return the boxes of the plates in a region; of one kind, if it is given."""
    drawn = _plates.get(region, ())
    return tuple(box for kind, box in drawn if of_kind in (None, kind))
