"""Common parts of all panels: tab, columns, wrapped sentences, warnings, colour swatches."""

import re
from bisect import bisect_left
from collections.abc import Callable, Collection, Iterable
from functools import lru_cache
from typing import Any

import blf
import bpy
from bpy.types import Context, PropertyGroup, UILayout

from ..caches.sensor_cache import sensors as listed_sensors
from ..engine import advice
from ..live import SAME, SENSE_ICONS
from ..operators import FIX_LABELS, ROW_LISTS
from ..panel_text import draw_label, is_simple, worded
from ..properties import INDEX_OF, ROWS, DeclaredRow, declared_rows

DrawPanel = Callable[[UILayout, PropertyGroup, Context], None]
DrawHeader = Callable[[UILayout, Context], None]
TAB: dict[str, Any] = {
    "bl_space_type": "VIEW_3D",
    "bl_region_type": "UI",
    "bl_category": "Perception",
}
BESIDE_PX = 72
ICON_PX = 20
"""Width of borders and the tab's name, and of an icon, at a scale of 1."""
BUTTON_PX = 26  # Width of a small button beside a sentence, at a scale of 1
POPUP_PX = 340  # Width of a panel that is called as a popup, at a scale of 1
MIN_ROOM_PX = 40  # A sidebar can be made narrower than any word
FONT = 0
WORD = re.compile(r"\s*\S+")


def is_empty(scene: bpy.types.Scene) -> bool:
    """Whether nothing is begun: no vehicle, no sensor, no score."""
    settings = scene.perception_entropy
    return settings.vehicle is None and not (settings.has_result or listed_sensors(scene))


def panel(
    label: str,
    *,
    simple: bool = False,
    always: bool = False,
    parent: str = "",
    closed: bool = True,
    poll: Callable[[Context], bool] | None = None,
    header: DrawHeader | None = None,
    preset: DrawHeader | None = None,
    count: str = "",
    chosen: str = "",
    **members: Any,
) -> Callable[[DrawPanel], type[bpy.types.Panel]]:
    """Return what makes a panel of the tab of a function, whose name and docstring it takes.

    The function draws into a layout; it takes the settings of the scene and the context. `parent`
    is the panel that it is in, `simple` whether *Simple* has it, `always` also in an empty
    file, `closed` whether it is at first, `poll` when it is there. `header`
    draws before its label, `preset` at the end of that line. There `count` shows how many rows a
    list has, and `chosen` the entry of a menu. Both are visible also when the panel is closed.
    `members` are attributes of the class.
    """

    def make(function: DrawPanel) -> type[bpy.types.Panel]:
        def draw(self: bpy.types.Panel, context: Context) -> None:
            function(self.layout, context.scene.perception_entropy, context)

        content: dict[str, Any] = {"__doc__": function.__doc__, "draw": draw}
        content |= TAB | {"__module__": function.__module__, "bl_label": label, **members}
        content |= {"bl_parent_id": parent} if parent else {}
        content |= {"bl_options": {"DEFAULT_CLOSED"}} if closed else {}
        content["poll"] = classmethod(
            lambda _cls, context: (
                (simple or not is_simple(context.scene))
                and (always or not is_empty(context.scene))
                and (poll is None or poll(context))
            )
        )
        if header is not None:
            content["draw_header"] = lambda self, context: header(self.layout, context)
        at_end = preset or ((count or chosen) and _header_text(count, chosen))
        if at_end:
            content["draw_header_preset"] = lambda self, context: at_end(self.layout, context)
        return type(f"PE_PT_{function.__name__}", (bpy.types.Panel,), content)

    return make


def _header_text(count: str, chosen: str) -> DrawHeader:
    def draw(layout: UILayout, context: Context) -> None:
        settings = context.scene.perception_entropy
        value = getattr(settings, count or chosen)
        text = layout.enum_item_name(settings, chosen, value) if chosen else str(len(value) or "")
        layout.label(text=text, translate=False)

    return draw


def row_list(
    name: str, **members: Any
) -> Callable[[Callable[[Context, UILayout, Any, Any], None]], type[bpy.types.UIList]]:
    """Return what makes a list of a function that draws a row of it. The function takes context,
    layout, the owner of the list and the row's item."""

    def make(function: Callable[[Context, UILayout, Any, Any], None]) -> type[bpy.types.UIList]:
        def draw_item(  # Blender counts the arguments
            _self: Any, context: Any, layout: Any, owner: Any, item: Any, _icon: Any, _active: Any
        ) -> None:
            function(context, layout, owner, item)

        content = {"__doc__": function.__doc__, "__module__": function.__module__}
        return type(name, (bpy.types.UIList,), {**content, "draw_item": draw_item, **members})

    return make


def draw_properties(layout: UILayout, settings: PropertyGroup, names: Iterable[str]) -> None:
    """Draw properties below each other, their names in a column of its own."""
    layout.use_property_split = True
    layout.use_property_decorate = False
    for name in names:
        _draw_row(layout, settings, ROWS.get(name) or DeclaredRow(name))


def draw_declared(
    layout: UILayout, settings: PropertyGroup, part: str, leave_out: Collection[str] = ()
) -> None:
    """Draw what the engine declares for a part of the panel, each field where it is asked for."""
    rows = (row for row in declared_rows(part) if row.name not in leave_out)
    draw_properties(layout, settings, [row.name for row in rows if is_asked(settings, row.when)])


def is_asked(settings: PropertyGroup, when: str) -> bool:
    """Whether a condition holds: "night", "targets=objects", "targets!=objects"; "" does."""
    name, _, value = when.partition("=")
    found = getattr(settings, name.removesuffix("!")) if name else True
    return (found == value) != name.endswith("!") if value else bool(found)


def _draw_row(layout: UILayout, settings: PropertyGroup, row: DeclaredRow) -> None:
    """Draw a property; a range as two fields, marked where it is none."""
    if row.is_list:
        layout.column(align=True).prop(settings, row.name)
    elif row.is_pair:
        cells = layout.row(align=True)
        cells.use_property_split = False
        low, high = getattr(settings, row.name)
        cells.alert = low > high
        draw_label(cells, settings.bl_rna.properties[row.name].name)
        for index in (0, 1):
            cells.prop(settings, row.name, index=index, text="")
    elif row.beside:
        cells = layout.row(align=True)
        cells.prop(settings, row.name)
        if not getattr(settings, row.name):
            draw_label(cells, row.beside)
    else:
        layout.prop(settings, row.name)


def draw_list(
    layout: UILayout,
    kind: type[bpy.types.UIList],
    settings: PropertyGroup,
    name: str,
    height: int = 3,
    add: str = "pe.add_row",
) -> None:
    """Draw the list of some rows, by their property, with its buttons beside it. `add` is the
    operator that adds a row, where that has a button of its own."""
    row = layout.row()
    row.use_property_split = False
    row.template_list(kind.__name__, "", settings, name, settings, INDEX_OF[name], rows=height)
    column = row.column(align=True)
    rows = ROW_LISTS[name]
    button = column.operator(add, text="", icon="ADD")
    if rows.add is not None:
        button.rows = name
    below = column.column(align=True)
    below.enabled = getattr(settings, INDEX_OF[name]) < len(getattr(settings, name))
    below.operator("pe.remove_row", text="", icon="REMOVE").rows = name
    if rows.copy is not None and not is_simple(settings.id_data):
        below.operator("pe.copy_row", text="", icon="DUPLICATE").rows = name
    is_moved = rows.is_ordered and not is_simple(settings.id_data)
    for step, icon in ((-1, "TRIA_UP"), (1, "TRIA_DOWN")) if is_moved else ():
        move = below.operator("pe.move_row", text="", icon=icon)
        move.rows = name
        move.step = step


def section(
    layout: UILayout, name: str, title: str, *, count: str = "", closed: bool = True
) -> UILayout | None:
    """Draw the header of a part of a panel that folds; return the layout inside, None where it is
    closed. `name` is what Blender remembers it by; `count` is drawn at the end of the header."""
    header, inside = layout.panel(f"PE_{name}", default_closed=closed)
    draw_label(header, title)
    if count:
        at_end = header.row()
        at_end.alignment = "RIGHT"
        at_end.label(text=count, translate=False)
    return inside


def draw_stale_mark(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw a mark above figures of a result that is out of date."""
    if settings.result_stale:
        draw_label(layout, "From the last score, before a change", "FILE_REFRESH")


def columns(layout: UILayout, factor: float, align: bool = False) -> tuple[UILayout, UILayout]:
    """Return two rows beside each other; the first takes that share of the width."""
    split = layout.split(factor=factor, align=align)
    return split.row(), split.row()


def wrapped(context: Context, text: str, beside_px: float = 0.0) -> tuple[str, ...]:
    """Return a sentence in lines that fit the sidebar, measured in its font."""
    return wrapped_lines(text, *room_px(context, BESIDE_PX + beside_px))


def fitted(context: Context, text: str, beside_px: float, share: float) -> str:
    """Return a text that fits that share of the sidebar: see `shortened_to`."""
    return shortened_to(context, text, room_px(context, BESIDE_PX + beside_px, share)[0])


def shortened_to(context: Context, text: str, room: float) -> str:
    """Return a text that fits a room [px]: its middle is left out where there is none, as names
    differ at their ends."""
    blf.size(FONT, room_px(context, 0.0)[1])
    shorter = text
    half = (len(text) + 1) // 2
    while half > 1 and _width(shorter) > room:
        half -= 1
        shorter = f"{text[:half]}\N{HORIZONTAL ELLIPSIS}{text[-half:]}"
    return shorter


def text_px(text: str, size_px: float) -> float:
    """Return the width of a text in that size of the font [px]."""
    blf.size(FONT, size_px)
    return _width(text)


def room_px(context: Context, beside_px: float, share: float = 1.0) -> tuple[float, float]:
    """Return the room in the sidebar beside something, and the size of the font [px]."""
    scale = _scale(context)
    is_popup = getattr(context.region, "type", "UI") != "UI"  # its own width is not known
    width = POPUP_PX * scale if is_popup else context.region.width
    room = (width - beside_px * scale) * share
    points = context.preferences.ui_styles[0].widget.points
    return max(room, MIN_ROOM_PX * scale), points * scale


@lru_cache(maxsize=512)
def wrapped_lines(text: str, room_px: float, size_px: float) -> tuple[str, ...]:
    """Break a text so that no line of that size is wider than the room; a longer word is cut up."""
    blf.size(FONT, size_px)
    lines = []
    line = ""
    for word in WORD.findall(text):
        longer = f"{line}{word}".strip()
        if line and _width(longer) > room_px:
            lines.append(line)
            longer = word.strip()
        *full, line = _pieces(longer, room_px)
        lines += full
    return (*lines, line)


def _pieces(text: str, room_px: float) -> list[str]:
    """Cut a text into pieces that are not too wide; a text that fits is one piece."""
    pieces = []
    while len(text) > 1 and _width(text) > room_px:
        fits = bisect_left(range(1, len(text)), True, key=lambda k: _width(text[:k]) > room_px)
        pieces.append(text[: max(fits, 1)])
        text = text[max(fits, 1) :]
    return [*pieces, text]


def _width(text: str) -> float:
    return blf.dimensions(FONT, text)[0]


def _scale(context: Context) -> float:
    return context.preferences.system.ui_scale or 1.0  # 0 without a window


def draw_sentence(
    layout: UILayout,
    context: Context,
    text: str,
    icon: str = "NONE",
    beside_px: float = 0.0,
    sense: int = SAME,
    room_of: str = "",
) -> None:
    """Draw a sentence in as many lines as it needs; the icon is before the first. It takes the
    room of `room_of`, if that is longer: what comes late moves nothing. A gain or a loss
    (`sense`) has its own icon. A sentence that begins with a space continues the one before, and
    has no icon. `beside_px` is the width of what is beside the sentence, at a scale of 1."""
    if text.startswith(" "):
        text = text.strip()
        icon = "BLANK1"
    column = layout.column(align=True)
    column.scale_y = 0.8
    icon = icon if sense == SAME else SENSE_ICONS[sense]
    rest = "NONE" if icon == "NONE" else "BLANK1"
    beside_px += 0.0 if icon == "NONE" else ICON_PX
    lines = wrapped(context, worded(context.scene, text), beside_px)
    for k, line in enumerate(lines):
        column.label(text=line, icon=rest if k else icon, translate=False)
    for _ in range(len(lines), len(wrapped(context, room_of)) if room_of else 0):
        column.label(text="")


def draw_warning(layout: UILayout, context: Context, warning: advice.Advice) -> None:
    """Draw a warning, the part that causes it as a button, and a button that fixes it."""
    draw_sentence(layout, context, warning.text[:1].upper() + warning.text[1:], icon="ERROR")
    if not (warning.fix in FIX_LABELS or warning.part):
        return
    row = layout.row(align=True)
    row.label(text="", icon="BLANK1")
    if warning.part:
        part = row.operator(
            "pe.select_object", text=warning.part, icon="RESTRICT_SELECT_OFF", translate=False
        )
        part.name = warning.part
    if warning.fix in FIX_LABELS:
        button = row.operator(
            "pe.fix_warning", text=FIX_LABELS[warning.fix], icon="TOOL_SETTINGS", translate=False
        )
        button.fix = warning.fix
        button.subject = warning.subject or ""
        button.amount = (*warning.amount, 0.0, 0.0, 0.0)[:3]
