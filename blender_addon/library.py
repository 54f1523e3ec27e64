"""The extension's preferences, and its assets: the library in Blender's browser, the example."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import bpy
from bpy.props import BoolProperty, StringProperty

from .engine import catalog

NAME = "Perception Entropy"
FOLDER = Path(__file__).resolve().parent / "assets"
EXAMPLES = (FOLDER / "examples", FOLDER.parents[1] / "blend_assets")
"""Where the example is: in the extension, or in a checkout of the project."""
EXAMPLE = "sedan.blend"


def example_file() -> Path | None:
    """Return the example to open; None if this installation does not have it."""
    return next((each / EXAMPLE for each in EXAMPLES if (each / EXAMPLE).is_file()), None)


WEBSITE = "https://extensions.blender.org/add-ons/perception-entropy/"
"""As in the manifest."""


def show_or_hide(preferences: bpy.types.AddonPreferences, _context: bpy.types.Context) -> None:
    """Update callback: show the library, or hide it."""
    (show if preferences.show_library else hide)()


def _models(kind: str) -> Callable[..., list[str]]:
    """Return a function for `search` of a property: names of the catalogue that contain a text."""

    def suggestions(_owner: object, _context: bpy.types.Context, typed: str) -> list[str]:
        return [name for name in catalog.names(kind) if typed.lower() in name.lower()]

    return suggestions


class PE_Preferences(bpy.types.AddonPreferences):
    """Preferences of the extension"""

    bl_idname = __package__

    show_library: BoolProperty(
        name="Sensors in the Asset Browser",
        description="A library of LiDARs and cameras: drag one onto the vehicle",
        default=True,
        update=show_or_hide,
    )

    lidar_model: StringProperty(
        name="Add LiDAR",
        description="Model that the button Add LiDAR adds; empty: the extension's own choice",
        search=_models("lidar"),
    )
    camera_model: StringProperty(
        name="Add Camera",
        description="Model that the button Add Camera adds; empty: the extension's own choice",
        search=_models("camera"),
    )
    results_folder: StringProperty(
        name="Folder of Results",
        description="Folder that the file dialogs of exports open in; empty: the .blend file's",
        subtype="DIR_PATH",
    )

    def draw(self, _context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.use_property_split = True
        for name in ("lidar_model", "camera_model", "results_folder", "show_library"):
            column.prop(self, name)
        self.layout.operator("wm.url_open", text="Website", icon="URL").url = WEBSITE


def preferences() -> PE_Preferences | None:
    """Return the preferences; None where the add-on is not enabled in Blender's own."""
    addon = bpy.context.preferences.addons.get(__package__)
    return None if addon is None else addon.preferences


def preferred_model(kind: str) -> str:
    """Return the model of a kind that the preferences name; "" without one in the catalogue."""
    model = getattr(preferences(), f"{kind}_model", "")
    return model if model in catalog.names(kind) else ""


def in_results_folder(filepath: str, otherwise: str) -> str:
    """Return the path that a file dialog begins with: in the preferred folder, if there is one.

    Parameters
    ----------
    filepath : str
        The path so far: a name, an absolute path, which is returned as it is, or "".
    otherwise : str
        Name of the file where the path so far is "".
    """
    folder = getattr(preferences(), "results_folder", "")
    if not folder or Path(filepath).is_absolute() or filepath.startswith("//"):
        return filepath
    return str(Path(bpy.path.abspath(folder)) / (filepath or otherwise))


def show() -> None:
    """Add the library to Blender's, once; another library of the same name is left alone."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    if not any(map(_is_ours, libraries)):
        made = libraries.new(name=NAME, directory=str(FOLDER))
        made.import_method = "APPEND"


def hide() -> None:
    """Remove the library from Blender's; do nothing if it is not there."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    for library in [each for each in libraries if _is_ours(each)]:
        libraries.remove(library)


def _is_ours(library: bpy.types.UserAssetLibrary) -> bool:
    path = bpy.path.abspath(library.path)
    return bool(path) and Path(path).resolve() == FOLDER


def is_wanted() -> bool:
    """Whether to show it: as the preferences say; without preferences, where there is a window."""
    chosen = preferences()
    return not bpy.app.background if chosen is None else chosen.show_library


def register() -> None:
    """Show the library if it is wanted."""
    if is_wanted():
        show()


def unregister() -> None:
    """Hide the library."""
    hide()


CLASSES = (PE_Preferences,)
