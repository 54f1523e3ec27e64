"""Entries in Blender's own menus: for sensors, for meshes, and for the search of F3."""

from types import SimpleNamespace

import bpy

from blender_addon.panels import menus
from tests.addon import layouts


def test_every_button_of_the_menu_is_an_operator(addon):
    class Names(layouts.Layout):
        def operator(self, name, **_):
            self.notes.append(name)

    layout = Names()
    menus.PE_MT_object.draw(SimpleNamespace(layout=layout), bpy.context)
    names = [name for name in layout.notes if isinstance(name, str)]
    assert len(names) > 10
    for name in names:
        module, function = name.split(".")
        getattr(getattr(bpy.ops, module), function).get_rna_type()
