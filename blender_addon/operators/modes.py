"""The one mode of clicking that is active: what begins it, what ends it, and its text at the mouse.

A mode begins by its button. It ends with Esc, a right click, its subject, or any other tool: an
operator, a key that is none of the view's, a job, or another mode.
"""

from collections.abc import Iterable

import bpy

from ..panel_text import draw_label
from ..view import viewport

TEXT_PX = 12
PAD_PX = 6
TEXT_GAP = 1.5
TEXT_AT = (26, -12)
"""Text beside the mouse: its size, the room around it, its rows, and where it begins."""
OF_VIEW = (
    "NUMPAD_",
    "MIDDLEMOUSE",
    "WHEEL",
    "TRACKPAD",
    "MOUSE",
    "NDOF",
    "TIMER",
    "WINDOW",
    "HOME",
)
"""How events begin that turn, move and zoom the view, or are Blender's own: they pass."""
OF_NOTHING = ("INBETWEEN", "NONE", "ACTIONZONE", "EVT_", "LEFT_", "RIGHT_", "OSKEY")
"""How events begin that do nothing by themselves, as keys that are held."""


class Mode:
    """A mode of clicking, until it is ended."""

    def __init__(self, context: bpy.types.Context, hint: str) -> None:
        self.hint = hint
        self._region = 0
        self._mouse = (0, 0)
        self._last = _last_operator()
        self._handlers = viewport.DrawHandlers()
        self._handlers.show((self._draw, "POST_PIXEL"))
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set(_draw_status)

    @property
    def is_left(self) -> bool:
        """Whether another operator was executed since the mode began."""
        return self._last != _last_operator()

    def point(self, region: int, mouse: tuple[int, int]) -> None:
        """Draw the hint at the mouse, in a region by its pointer; 0: nowhere."""
        self._region = region
        self._mouse = mouse
        viewport.redraw_editors()

    def end(self) -> None:
        """Restore the mouse cursor and the status bar, and remove the hint."""
        self._handlers.hide()
        for manager in bpy.data.window_managers:
            for window in manager.windows:
                window.cursor_modal_restore()
        for workspace in bpy.data.workspaces[:1]:
            workspace.status_text_set(None)
        viewport.redraw_editors()

    def _draw(self) -> None:
        region = bpy.context.region
        if region is not None and region.as_pointer() == self._region:
            draw_at_mouse(self._mouse, (self.hint,))


current: Mode | None = None


def begin(context: bpy.types.Context, hint: str) -> Mode:
    """Begin a mode; the one before it ends."""
    global current
    end()
    current = Mode(context, hint)
    return current


def end() -> None:
    """End the mode; do nothing if there is none."""
    global current
    if current is not None:
        ended = current
        current = None
        ended.end()


def is_of_view(event_type: str) -> bool:
    """Whether an event turns the view, or is none that a tool begins with."""
    return event_type.startswith((*OF_VIEW, *OF_NOTHING)) and "BRACKET" not in event_type


def draw_at_mouse(mouse: tuple[int, int], lines: Iterable[str]) -> None:
    """Draw lines of text beside the mouse, clear of the sidebar."""
    texts = list(lines)
    scale = viewport.ui_scale()
    size = TEXT_PX * scale
    pad = PAD_PX * scale
    row = size * TEXT_GAP
    left, top = (at + off * scale for at, off in zip(mouse, TEXT_AT, strict=True))
    width = max((viewport.text_size(line, size)[0] for line in texts), default=0.0)
    low = top - row * (len(texts) - 1) - pad
    left = min(left, viewport.sidebar_left(bpy.context) - width - 2.0 * pad)
    viewport.fill_box((left - pad, low, left + width + pad, top + row), viewport.PLATE)
    for number, line in enumerate(texts):
        viewport.draw_text(line, left, top - number * row, size, color=viewport.INK)


def _draw_status(header: bpy.types.Header, _context: bpy.types.Context) -> None:
    """Draw the hint in the status bar, in place of Blender's own."""
    if current is not None:
        draw_label(header.layout.row(), current.hint, "EYEDROPPER")


def _last_operator() -> int:
    """Return a number of the operator that was executed last; 0 before the first."""
    operators = bpy.context.window_manager.operators
    return operators[-1].as_pointer() if len(operators) else 0
