"""Keys of the extension in 3D views; Blender's preferences list them, and can change them."""

from __future__ import annotations

from typing import Any, NamedTuple

import bpy


class Shortcut(NamedTuple):
    """A key in 3D views: the operator and its properties, the key, and its modifiers."""

    operator: str
    key: str
    modifiers: dict[str, bool] = {}
    properties: dict[str, Any] = {}


CTRL_ALT = {"ctrl": True, "alt": True}
SHORTCUTS = (
    Shortcut("pe.look_back", "ESC"),
    Shortcut("wm.context_toggle", "L", CTRL_ALT, {"data_path": "scene.perception_entropy.live.on"}),
    Shortcut("pe.place_sensor", "P", CTRL_ALT),
    Shortcut("pe.ghost_variant", "V", CTRL_ALT),
)
"""Of Ctrl Alt, Blender uses none of these letters in 3D views."""

_items: list[tuple[bpy.types.KeyMap, bpy.types.KeyMapItem]] = []


def register() -> None:
    """Add the keys, where there is a window."""
    keys = bpy.context.window_manager.keyconfigs.addon
    if keys is not None:  # there are none without a window
        add_to(keys.keymaps.new(name="3D View", space_type="VIEW_3D"))


def add_to(keymap: bpy.types.KeyMap) -> None:
    """Add the keys to a key map."""
    for each in SHORTCUTS:
        item = keymap.keymap_items.new(each.operator, each.key, "PRESS")
        for name, value in each.modifiers.items():
            setattr(item, name, value)
        for name, value in each.properties.items():
            setattr(item.properties, name, value)
        _items.append((keymap, item))


def unregister() -> None:
    """Remove the keys."""
    while _items:
        keymap, item = _items.pop()
        keymap.keymap_items.remove(item)
