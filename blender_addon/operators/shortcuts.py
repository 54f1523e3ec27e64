"""Keys of the extension in 3D views; Blender's preferences list them, and can change them."""

from typing import Any, NamedTuple

import bpy

CTRL_ALT: dict[str, Any] = {"ctrl": True, "alt": True}
LIVE = {"data_path": "scene.perception_entropy.live.on"}
IN_VIEW = ("3D View", "VIEW_3D")
IN_OBJECT_MODE = ("Object Mode", "EMPTY")
"""Names and spaces of Blender's key maps. That of a mode is asked first: a key of Blender's own in
it would be taken before one of the view."""


class Shortcut(NamedTuple):
    """An operator's key. Where the operator is not possible, the key does what Blender's does."""

    operator: str
    key: str
    modifiers: dict[str, Any] = {}
    properties: dict[str, Any] = {}
    keymap: tuple[str, str] = IN_VIEW


SHORTCUTS = (
    Shortcut("pe.look_back", "ESC"),
    Shortcut("wm.context_toggle", "L", CTRL_ALT, LIVE),
    Shortcut("pe.place_sensor", "P", CTRL_ALT),
    Shortcut("pe.ghost_variant", "V", CTRL_ALT),
    Shortcut("pe.take_better_place", "M", keymap=IN_OBJECT_MODE),
)
"""Of Ctrl Alt, Blender uses none of these letters."""

_items: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


def register() -> None:
    """Add the keys, where there is a window."""
    keys = bpy.context.window_manager.keyconfigs.addon
    if keys is not None:  # there are none without a window
        add_to(keys)


def add_to(keys: bpy.types.KeyConfig) -> None:
    """Add the keys to a configuration of keys."""
    for row in SHORTCUTS:
        name, space = row.keymap
        keymap = keys.keymaps.new(name=name, space_type=space)
        item = keymap.keymap_items.new(row.operator, row.key, "PRESS", **row.modifiers)
        for prop, value in row.properties.items():
            setattr(item.properties, prop, value)
        _items.append((keymap, item))


def unregister() -> None:
    """Remove the keys."""
    while _items:
        keymap, item = _items.pop()
        keymap.keymap_items.remove(item)
