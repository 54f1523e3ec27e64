"""The extension's preferences, as Blender stores and draws them."""

import bpy

from .. import library, signals
from ..library import stored
from ..panel_text import draw_label
from ..properties import fields
from . import own_catalog, verification


def show_or_hide(preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    """Update callback: show the library, or hide it."""
    (library.show if preferences.show_library else library.hide)()


def load_catalog(preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    """Update callback: load the catalogue of own sensors in place of the one before."""
    own_catalog.load(preferences.own_catalog)
    signals.study_changed.emit()


def redraw(_preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    """Update callback: draw the overlay and the panel again."""
    signals.view_changed.emit()


class PE_Preferences(bpy.types.AddonPreferences):
    """Preferences of the extension"""

    bl_idname = library.ADDON

    show_library: fields.switch(
        "Sensors in the Asset Browser",
        "A library of LiDARs and cameras: drag one onto the vehicle",
        True,
        update=show_or_hide,
    )
    own_catalog: fields.text(
        "Own Catalogue",
        "File of sensors of your own, for all files: tables as in a study, by name (.toml)",
        subtype="FILE_PATH",
        update=load_catalog,
    )

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        column = self._section("Files")
        column.prop(self, "own_catalog")
        if own_catalog.problem:
            draw_label(column, own_catalog.problem, "ERROR")
        column.prop(self, "show_library")
        column = self._section("Engine")
        column.operator("pe.verify_engine", icon="CHECKMARK")
        if verification.is_running():
            draw_label(column, "Golden cases are being computed", "SORTTIME")
        for number, line in enumerate(verification.lines()):
            draw_label(column, line, "ERROR" if number else "NONE")

    def _section(self, heading: str) -> bpy.types.UILayout:
        """Draw a heading; return a column below it. Blender draws a column's own only at a tick."""
        draw_label(self.layout, heading)
        return self.layout.column()


CLASSES = (PE_Preferences,)


def register() -> None:
    """Load the catalogue that the preferences name."""
    own_catalog.load(getattr(stored(), "own_catalog", ""))


def unregister() -> None:
    """Take its sensors out of the catalogue."""
    own_catalog.load("")
