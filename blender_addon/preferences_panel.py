"""The extension's preferences, as Blender stores and draws them."""

from __future__ import annotations

from typing import Any

import bpy

from . import library, own_catalog, signals
from .engine import app, catalog, graphics
from .language import draw_label
from .preferences import COLORS, LIVE_BUDGET_MS, mark_seen, stored
from .properties import fields
from .sensor_kinds import mount_of
from .translation_context import CONTEXT


def show_or_hide(preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    """Update callback: show the library, or hide it."""
    (library.show if preferences.show_library else library.hide)()


def load_catalog(preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    """Update callback: load the catalogue of own sensors in place of the one before."""
    own_catalog.load(preferences.own_catalog)
    signals.study_changed.emit()


def _model(kind: str, label: str) -> Any:
    """Return the property of the usual model of a kind."""

    def suggestions(_owner: object, _context: bpy.types.Context, typed: str) -> list[str]:
        return [name for name in catalog.names(kind) if typed.lower() in name.lower()]

    about = "Model that Add and Place put on the vehicle; empty: the extension's choice"
    return fields.text(label, about, search=suggestions)


def redraw(_preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    """Update callback: draw the overlay and the panel again."""
    signals.view_changed.emit()


def _color(label: str, about: str, default: graphics.Rgba) -> Any:
    """Return the property of a colour of the overlay."""
    options = {"default": default, "subtype": "COLOR_GAMMA", "update": redraw}
    return fields.numbers(label, about, 4, min=0.0, max=1.0, **options)


NAMES_SHARE = 0.4
"""Share of the width that Blender gives to names of properties."""


class PE_Preferences(bpy.types.AddonPreferences):
    """Preferences of the extension"""

    bl_idname = __package__

    seen_version: fields.text("Version", "Version whose news were shown", options={"HIDDEN"})
    show_library: fields.switch(
        "Sensors in the Asset Browser",
        "A library of LiDARs and cameras: drag one onto the vehicle",
        True,
        update=show_or_hide,
    )
    lidar_model: _model("lidar", "LiDAR")
    camera_model: _model("camera", "Camera")
    radar_model: _model("radar", "Radar")
    ultrasonic_model: _model("ultrasonic", "Ultrasonic")
    own_catalog: fields.text(
        "Own Catalogue",
        "File of sensors of your own, for all files: tables as in a study, by name (.toml)",
        subtype="FILE_PATH",
        update=load_catalog,
    )
    results_folder: fields.text(
        "Folder of Results",
        "Folder that the file dialogs of exports open in; empty: the .blend file's",
        subtype="DIR_PATH",
    )
    live_budget_ms: fields.number(
        "Live Budget [ms]",
        "While a sensor moves, its score is exact where that takes no longer than this, and a "
        "preview where it does; 0: always a preview",
        LIVE_BUDGET_MS,
        min=0.0,
        soft_max=200.0,
        precision=0,
        step=500,
    )
    length_unit: fields.menu(
        "Lengths in Texts",
        "Unit of lengths in the read-out, in warnings and in reports",
        (
            ("M", "Metres", "Lengths in metres: 0.35 m"),
            ("MM", "Millimetres", "Lengths up to 100 m with decimals in millimetres: 350 mm"),
        ),
        update=redraw,
    )
    free_color: _color(
        "Free Beams", "Beams that the vehicle does not block", graphics.VIEWPORT.free
    )
    blocked_color: _color(
        "Occluded Beams", "Beams that end on the vehicle", graphics.VIEWPORT.occluded
    )
    blind_color: _color("Blind Ground", "Ground that no sensor sees", graphics.VIEWPORT.blind)

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        models = self._section("Usual Models")
        for kind in ("lidar", "camera", "radar", "ultrasonic"):
            models.prop(self, f"{kind}_model", placeholder=mount_of(kind).usual)
        column = self._section("Files")
        column.prop(self, "own_catalog")
        if own_catalog.problem:
            draw_label(column, own_catalog.problem, "ERROR")
        for name in ("results_folder", "show_library"):
            column.prop(self, name)
        column = self._section("Score and Texts")
        column.prop(self, "live_budget_ms")
        column.row().prop(self, "length_unit", expand=True)
        colors = self._section("Colours of the Overlay")
        for name in COLORS:
            colors.prop(self, name)
        row = self.layout.split(factor=NAMES_SHARE)
        row.separator()
        link = row.operator("wm.url_open", text="Website", text_ctxt=CONTEXT, icon="URL")
        link.url = app.WEBSITE

    def _section(self, heading: str) -> bpy.types.UILayout:
        """Draw a heading; return a column below it. Blender draws a column's own only at a tick."""
        draw_label(self.layout, heading)
        return self.layout.column()


CLASSES = (PE_Preferences,)


def register() -> None:
    """Load the catalogue that the preferences name. A first installation has no news."""
    if not getattr(stored(), "seen_version", ""):
        mark_seen()
    own_catalog.load(getattr(stored(), "own_catalog", ""))


def unregister() -> None:
    """Take its sensors out of the catalogue."""
    own_catalog.load("")
