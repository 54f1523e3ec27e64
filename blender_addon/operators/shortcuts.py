"""Keys of the extension in 3D views; Blender's preferences list them, and can change them."""

from typing import Any

import bpy

CTRL_ALT: dict[str, Any] = {"ctrl": True, "alt": True}
LIVE = {"data_path": "scene.perception_entropy.live.on"}
SHORTCUTS: tuple[tuple[str, str, dict[str, Any], dict[str, Any]], ...] = (
    ("pe.look_back", "ESC", {}, {}),
    ("wm.context_toggle", "L", CTRL_ALT, LIVE),
    ("pe.place_sensor", "P", CTRL_ALT, {}),
    ("pe.ghost_variant", "V", CTRL_ALT, {}),
)
"""Operator, key, modifiers and properties. Of Ctrl Alt, Blender uses none of these letters."""

_items: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


def register() -> None:
    """Add the keys, where there is a window."""
    keys = bpy.context.window_manager.keyconfigs.addon
    if keys is not None:  # there are none without a window
        add_to(keys.keymaps.new(name="3D View", space_type="VIEW_3D"))


def add_to(keymap: bpy.types.KeyMap) -> None:
    """Add the keys to a key map."""
    for operator, key, modifiers, properties in SHORTCUTS:
        item = keymap.keymap_items.new(operator, key, "PRESS", **modifiers)
        for name, value in properties.items():
            setattr(item.properties, name, value)
        _items.append((keymap, item))


def unregister() -> None:
    """Remove the keys."""
    while _items:
        keymap, item = _items.pop()
        keymap.keymap_items.remove(item)
