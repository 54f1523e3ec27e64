"""Entries in Blender's own menus: for sensors, for meshes, and for the search of F3."""

from types import SimpleNamespace

import bpy

from blender_addon.engine import catalog, kinds
from blender_addon.operators import add_sensor
from blender_addon.panels import menus, overlay_popover
from tests.addon import layouts, scenes


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


def context_menu(scene, obj, mode="OBJECT"):
    """Buttons of a right click on an object."""
    layout = layouts.Layout()
    context = SimpleNamespace(scene=scene, active_object=obj, mode=mode)
    menus.draw_context_menu(SimpleNamespace(layout=layout), context)
    return layout.texts("operator")


def test_a_right_click_offers_what_fits_the_object(addon):
    scene = bpy.context.scene
    mesh = bpy.data.objects.new("part", bpy.data.meshes.new("part"))
    assert context_menu(scene, None) == context_menu(scene, mesh, "EDIT_MESH") == []
    assert context_menu(scene, mesh) == ["Use Selected Objects as Vehicle"]
    sensor = scenes.add_sensor("roof")
    assert context_menu(scene, sensor)[0] == "pe.look_through"
    scene.perception_entropy.vehicle = bpy.data.collections.new("Car")
    assert context_menu(scene, mesh) == ["pe.place_sensor"]


def test_sensors_are_in_blender_s_menu_add_and_the_view_in_its_header(car):
    menu = layouts.drawn(menus.PE_MT_add)
    assert menu.texts("operator") == [*(kind.label for kind in kinds.KINDS.values()), "Search..."]
    for mode, entries in (("OBJECT", ["PE_MT_add"]), ("EDIT_MESH", [])):
        layout = layouts.Layout()
        menus.draw_add_menu(SimpleNamespace(layout=layout), SimpleNamespace(mode=mode))
        assert layout.texts("menu") == entries
    items = add_sensor.menu_items(SimpleNamespace(kind="lidar"), bpy.context)
    assert [each[0] for each in items] == catalog.names("lidar")
    (found,) = [each for each in items if "QT128" in each[1]]
    assert "range 50 m" in found[2], "figures are searched too"
    header = layouts.Layout()
    overlay_popover.draw_in_header(SimpleNamespace(layout=header), SimpleNamespace(scene=car))
    assert header.notes == [("prop", "show_overlay"), ("popover", "PE_PT_view")]
