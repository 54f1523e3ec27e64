"""The sensors in Blender's asset browser: a library of its own, which comes and goes with us."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.props import BoolProperty

NAME = "Perception Entropy"
FOLDER = Path(__file__).resolve().parent / "assets"


def follow_wish(preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    """Update callback: show the library, or take it away."""
    (show if preferences.show_library else hide)()


class PE_Preferences(bpy.types.AddonPreferences):
    """What is set for the extension as a whole"""

    bl_idname = __package__

    show_library: BoolProperty(
        name="Sensors in the Asset Browser",
        description="A library of LiDARs and cameras: drag one onto the vehicle",
        default=True,
        update=follow_wish,
    )

    def draw(self, _context: bpy.types.Context) -> None:
        self.layout.prop(self, "show_library")


def show() -> None:
    """Have the library among Blender's, once; whatever else has its name is left alone."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    if not any(map(_is_ours, libraries)):
        made = libraries.new(name=NAME, directory=str(FOLDER))
        made.import_method = "APPEND"


def hide() -> None:
    """Take the library away from Blender's; do nothing if it is not there."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    for library in [each for each in libraries if _is_ours(each)]:
        libraries.remove(library)


def _is_ours(library: bpy.types.UserAssetLibrary) -> bool:
    path = bpy.path.abspath(library.path)
    return bool(path) and Path(path).resolve() == FOLDER


def is_wanted() -> bool:
    """Whether to show it: as the preferences say; without any, where somebody looks at a window."""
    addon = bpy.context.preferences.addons.get(__package__)
    return not bpy.app.background if addon is None else addon.preferences.show_library


def register() -> None:
    """Show the library if it is wanted."""
    if is_wanted():
        show()


def unregister() -> None:
    """Take it away."""
    hide()


CLASSES = (PE_Preferences,)
