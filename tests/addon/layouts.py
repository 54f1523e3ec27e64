"""Panels and menus drawn without a window: a layout that notes what is put into it."""

from types import SimpleNamespace
from typing import ClassVar

import bpy


class Layout:
    """Takes what a panel draws, in rows and columns alike, and notes it in order."""

    def __init__(self, notes=None):
        self.notes = [] if notes is None else notes

    def texts(self, of: str) -> list[str]:
        """Texts of all labels, or of all buttons of operators."""
        return [text for kind, text in self.notes if kind == of]

    def label(self, text="", **_):
        self.notes.append(("label", text))

    def operator(self, name, text=None, **_):
        self.notes.append(("operator", name if text is None else text))
        return SimpleNamespace()

    def progress(self, factor=0.0, **_):
        self.notes.append(("bar", factor))

    def menu(self, name, **_):
        self.notes.append(("menu", name))

    def prop(self, _owner, name, **_):
        self.notes.append(("prop", name))

    def operator_menu_enum(self, name, _property, **_):
        self.notes.append(("menu", name))
        return SimpleNamespace()

    def template_list(self, name, *_lists, **_):
        self.notes.append(("list", name))

    def prop_enum(self, _owner, name, value, **_):
        self.notes.append(("prop_enum", (name, value)))

    def popover(self, panel, **_):
        self.notes.append(("popover", panel))

    def separator(self, **_):
        pass

    def context_string_set(self, name, value):
        self.notes.append((name, value))

    def _inner(self, **_):
        return Layout(self.notes)

    def panel(self, name, **_):
        self.notes.append(("panel", name))
        return self._inner(), self._inner()

    row = column = split = box = grid_flow = _inner


def drawn(cls, **context) -> Layout:
    """Return what a panel or a menu draws in a context of these members."""
    layout = Layout()
    cls.draw(SimpleNamespace(layout=layout), SimpleNamespace(**context))
    return layout


class Window:
    """What panels ask of the window that they are drawn in: wide enough for all columns."""

    def __init__(self, scene, active_object=None):
        self.scene = scene
        self.active_object = active_object
        self.region = SimpleNamespace(width=600)
        self.preferences = bpy.context.preferences


class View3D:
    """Stands for Blender's 3D views: counts what is drawn into them."""

    handles: ClassVar[set] = set()

    @classmethod
    def draw_handler_add(cls, *_):
        handle = object()
        cls.handles.add(handle)
        return handle

    @classmethod
    def draw_handler_remove(cls, handle, _region):
        cls.handles.remove(handle)
