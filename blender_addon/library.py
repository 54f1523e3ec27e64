"""The extension's preferences and assets: the library of sensors, and the example."""

from pathlib import Path

import bpy

ADDON = __package__
"""The extension in Blender's preferences."""
NAME = "Perception Entropy"
FOLDER = Path(__file__).resolve().parent / "assets"
EXAMPLES = (FOLDER / "examples", FOLDER.parents[1] / "blend_assets")
"""Where the example is: in the extension, or in a checkout of the project."""
EXAMPLE = "sedan.blend"


def stored() -> bpy.types.AddonPreferences | None:
    """Return the preferences; None where the add-on is not enabled in Blender's own."""
    addon = bpy.context.preferences.addons.get(ADDON)
    return None if addon is None else addon.preferences


def example_file() -> Path | None:
    """Return the example to open; None if this installation does not have it."""
    return next((each / EXAMPLE for each in EXAMPLES if (each / EXAMPLE).is_file()), None)


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


def register() -> None:
    """Show the library as the preferences say; without preferences, where there is a window."""
    chosen = stored()
    if not bpy.app.background if chosen is None else chosen.show_library:
        show()


def unregister() -> None:
    """Hide the library."""
    hide()
