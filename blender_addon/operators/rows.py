"""Rows of the panel's lists: one operator adds, removes, copies or moves a row of any list.

A module of the list's subject declares it with `row_list`; the panel draws its buttons by that.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeAlias

import bpy
from bpy.props import EnumProperty, IntProperty, StringProperty

from .. import signals
from ..choices import free_name
from ..properties import INDEX_OF
from .declared import INTERNAL, Answer, OperatorResult, Refused, operator

Kind: TypeAlias = tuple[str, str, str]
"""With what a row begins: its name, label and tooltip."""
SELECTED = -1
PLAIN: Kind = ("PLAIN", "Row", "")
"""The kind of rows that begin alike."""
MENU_LENGTH = 12
"""More kinds than these are searched for by their names, not chosen in a menu."""
ROW_OPTIONS = INTERNAL | {"UNDO"}
ROWS = StringProperty(name="List", description="Property of the list's rows: requirements, mounts")
INDEX = IntProperty(
    name="Index",
    description="Position of the row; -1: the selected one",
    default=SELECTED,
    min=SELECTED,
)


def of_scene(context: bpy.types.Context) -> bpy.types.PropertyGroup:
    """Return the settings of the scene, which most lists belong to."""
    return context.scene.perception_entropy


@dataclass(frozen=True, slots=True, kw_only=True)
class RowList:
    """A list of the panel, by the property of its rows.

    `noun` is what a row is. `add` adds one of a kind; its docstring is the tooltip. `copy` adds a
    copy of a row below it. `removing` fixes what refers to a row that is about to go; `loss` ends
    the tooltip of its removal. Rows of a list that `is_ordered` can be moved. `owner` has the list.
    """

    rows: str
    noun: str
    add: Callable[[bpy.types.Context, str], Answer] | None = None
    kinds: tuple[Kind, ...] | Callable[[], Iterable[Kind]] = ()
    copy: Callable[[bpy.types.Context, Any], str] | None = None
    removing: Callable[[bpy.types.Scene, Any], None] | None = None
    loss: str = ""
    is_ordered: bool = False
    owner: Callable[[bpy.types.Context], bpy.types.PropertyGroup] = of_scene
    signal: signals.Signal = signals.study_changed

    def kinds_now(self) -> tuple[Kind, ...]:
        """Return the kinds that a row can be of; empty where rows begin alike."""
        return tuple(self.kinds() if callable(self.kinds) else self.kinds)

    def row(self, context: bpy.types.Context, number: int) -> tuple[Any, int]:
        """Return the rows, and which of them is meant. `Refused` where there is no such row."""
        owner = self.owner(context)
        rows = getattr(owner, self.rows)
        if number == SELECTED and self.rows in INDEX_OF:
            number = getattr(owner, INDEX_OF[self.rows])
        if not 0 <= number < len(rows):
            raise Refused(f"No {self.noun} is selected")
        return rows, number

    def select(self, context: bpy.types.Context, number: int) -> None:
        """Select a row, or the last one where the list is shorter."""
        if self.rows in INDEX_OF:
            owner = self.owner(context)
            last = len(getattr(owner, self.rows)) - 1
            setattr(owner, INDEX_OF[self.rows], max(0, min(number, last)))


ROW_LISTS: dict[str, RowList] = {}
"""All lists, by the property of their rows."""
_listed: list[Kind] = []
"""What the menu lists: Blender reads the texts after the function that made them returned."""


def row_list(rows: str, noun: str, **options: Any) -> None:
    """Declare a list: see `RowList`."""
    ROW_LISTS[rows] = RowList(rows=rows, noun=noun, **options)


def new_row(
    scene: bpy.types.Scene, rows: str, wanted: str, taken: set[str] | None = None
) -> bpy.types.PropertyGroup:
    """Add a row to a list of the scene, select it, and return it; its name is the wanted one,
    numbered where it is taken."""
    settings = scene.perception_entropy
    found = getattr(settings, rows)
    name = free_name(wanted, {row.name for row in found} if taken is None else taken)
    row = found.add()
    row.name = name
    setattr(settings, INDEX_OF[rows], len(found) - 1)
    return row


def unless_selected(rows: str) -> Callable[[bpy.types.Context], str | None]:
    """Return what says why nothing can be done with the selected row of a list: there is none."""

    def unless(context: bpy.types.Context) -> str | None:
        try:
            ROW_LISTS[rows].row(context, SELECTED)
        except Refused as reason:
            return str(reason)
        return None

    return unless


def _kinds(chosen: Any, _context: object) -> list[Kind]:
    """Return the kinds of the operator's list, as items of a Blender menu."""
    found = ROW_LISTS.get(chosen.rows)
    _listed[:] = (found and found.kinds_now()) or (PLAIN,)
    return _listed


def _choose(self: Any, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
    """Ask for the kind where rows are of several kinds and none is given."""
    # The menu is made here: one that the panel draws of the property would not know the list.
    rows = self.rows
    found = ROW_LISTS.get(rows)
    kinds = () if found is None else found.kinds_now()
    if not kinds or self.properties.is_property_set("kind"):
        return self.execute(context)
    if len(kinds) > MENU_LENGTH:
        context.window_manager.invoke_search_popup(self)
        return {"RUNNING_MODAL"}

    def draw(menu: Any, _context: bpy.types.Context) -> None:
        for name, label, _ in kinds:
            entry = menu.layout.operator("pe.add_row", text=label, translate=False)
            entry.rows = rows
            entry.kind = name

    context.window_manager.popup_menu(draw)
    return {"INTERFACE"}


def _about_adding(about: str, chosen: Any) -> str:
    found = ROW_LISTS.get(chosen.rows)
    if found is None or found.add is None:
        return about
    return str(found.add.__doc__)  # Blender adds the kind's own tooltip


def _about_row(verb: str) -> Callable[[str, Any], str]:
    def tooltip(about: str, chosen: Any) -> str:
        found = ROW_LISTS.get(chosen.rows)
        if found is None:
            return about
        return f"{verb} the selected {found.noun}{found.loss if verb == 'Remove' else ''}"

    return tooltip


def _list_named(rows: str) -> RowList:
    if rows not in ROW_LISTS:
        raise Refused(f"There is no list {rows!r}: {', '.join(ROW_LISTS)}")
    return ROW_LISTS[rows]


@operator(
    "Add Row",
    options=ROW_OPTIONS,
    tooltip=_about_adding,
    invoke=_choose,
    bl_property="kind",
    rows=ROWS,
    kind=EnumProperty(items=_kinds, name="Kind", description="With what the row begins"),
)
def add_row(context: bpy.types.Context, rows: str, kind: str) -> Answer:
    """Add a row to a list of the panel"""
    chosen = _list_named(rows)
    if chosen.add is None:
        raise Refused(f"A {chosen.noun} is added by a button of its own")
    answer = chosen.add(context, kind)
    chosen.signal.emit()
    return answer


@operator("Remove Row", options=ROW_OPTIONS, tooltip=_about_row("Remove"), rows=ROWS, index=INDEX)
def remove_row(context: bpy.types.Context, rows: str, index: int) -> str:
    """Remove a row of a list of the panel"""
    chosen = _list_named(rows)
    found, number = chosen.row(context, index)
    name = str(found[number].name)
    if chosen.removing is not None:
        chosen.removing(context.scene, found[number])
    found.remove(number)
    chosen.select(context, number)
    chosen.signal.emit()
    return f"Removed {name or chosen.noun}"


@operator("Copy Row", options=ROW_OPTIONS, tooltip=_about_row("Copy"), rows=ROWS, index=INDEX)
def copy_row(context: bpy.types.Context, rows: str, index: int) -> str:
    """Add a copy of a row of a list of the panel below it"""
    chosen = _list_named(rows)
    if chosen.copy is None:
        raise Refused(f"A {chosen.noun} cannot be copied")
    found, number = chosen.row(context, index)
    name = chosen.copy(context, found[number])
    found.move(len(found) - 1, number + 1)
    chosen.select(context, number + 1)
    chosen.signal.emit()
    return f"Added {name}"


@operator(
    "Move Row",
    options=ROW_OPTIONS,
    tooltip=_about_row("Move"),
    rows=ROWS,
    index=INDEX,
    step=IntProperty(name="Step", description="-1: up; 1: down", default=-1, min=-1, max=1),
)
def move_row(context: bpy.types.Context, rows: str, index: int, step: int) -> Answer:
    """Move a row of a list of the panel: tables and pages have this order"""
    chosen = _list_named(rows)
    found, number = chosen.row(context, index)
    if not 0 <= number + step < len(found):
        return {"CANCELLED"}
    found.move(number, number + step)
    chosen.select(context, number + step)
    chosen.signal.emit()
    return None
