"""The first minute: a vehicle from what is selected, an example, and what the empty tab says."""

import math
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from blender_addon import diagnostics
from blender_addon.engine import kinds
from blender_addon.operators import shortcuts
from blender_addon.panels import CLASSES, main, sensor_menus
from tests.addon import scenes
from tests.addon.layouts import Layout, Window, drawn


def select(*chosen):
    """Select these objects and no other."""
    for obj in bpy.context.scene.objects:
        obj.select_set(obj in chosen)


@pytest.fixture
def body(scene):
    """Return two parts under a parent and a tree, all in the collection *Imported*."""
    imported = scenes.add_collection(scene.collection, "Imported")
    root = bpy.data.objects.new("root", None)
    imported.objects.link(root)
    shell, wheel = scenes.add_box(imported, "shell"), scenes.add_box(imported, "wheel")
    shell.parent = wheel.parent = root
    tree = scenes.add_box(imported, "tree")
    return SimpleNamespace(root=root, shell=shell, wheel=wheel, tree=tree)


def vehicle():
    return bpy.context.scene.perception_entropy.vehicle


def test_the_selected_meshes_become_a_collection_of_their_own_in_one_undo_step(body):
    select(body.root)
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.pe.use_selected("EXEC_DEFAULT", True) == {"FINISHED"}
    assert {obj.name for obj in vehicle().objects} == {"shell", "wheel"}
    imported = bpy.data.collections["Imported"]
    assert {obj.name for obj in imported.objects} == {"root", "tree"}, "in two collections"
    bpy.ops.ed.undo()
    assert vehicle() is None
    assert [each.name for each in bpy.data.collections] == ["Imported"]
    assert len(bpy.data.collections["Imported"].objects) == 4


def test_a_collection_of_the_selected_meshes_alone_is_taken(body):
    bpy.data.objects.remove(body.tree)
    select(body.shell, body.wheel)
    bpy.ops.pe.use_selected()
    assert vehicle().name == "Imported" and len(bpy.data.collections) == 1


def test_sensors_and_their_housings_are_no_parts(car):
    roof = car.objects["roof"]
    select(roof)
    with pytest.raises(RuntimeError, match="expected at least one mesh of the vehicle, found roof"):
        bpy.ops.pe.use_selected()
    select(roof, car.objects["body"], car.objects["cabin"])
    bpy.ops.pe.use_selected()
    assert vehicle().name == "Car", "the collection that has both parts"


def test_the_example_has_no_name_so_that_saving_it_does_not_change_the_extension(scene):
    assert bpy.ops.pe.open_example() == {"FINISHED"}
    assert bpy.data.filepath == "" and vehicle().name == "Sedan"
    assert bpy.ops.pe.score.poll()


def points_of(names, scene):
    """Return the centres of objects, in the ground frame, rounded [m]."""
    bpy.context.view_layer.update()
    return [tuple(round(c, 5) for c in scene.objects[n].matrix_world.translation) for n in names]


def test_turn_round_turns_the_vehicle_and_the_sensors_on_it_where_it_is(car):
    for obj in car.objects:
        obj.location.x += 3.0
    assert bpy.ops.pe.turn_round() == {"FINISHED"}
    assert points_of(("body", "cabin", "roof"), car) == [
        (3.0, 0.0, 0.55),
        (3.3, 0.0, 1.2),
        (3.43, 0.0, 1.8),
    ]
    bpy.ops.pe.turn_round()
    assert points_of(("cabin", "roof"), car) == [(2.7, 0.0, 1.2), (2.57, 0.0, 1.8)]


def test_stand_on_wheels_puts_the_vehicle_on_the_ground(scene):
    scenes.add_car(scene)
    bpy.context.view_layer.update()
    for obj in scene.perception_entropy.vehicle.objects:  # on its tail
        obj.matrix_world = Matrix.Rotation(-math.pi / 2, 4, "Y") @ obj.matrix_world
    bpy.context.view_layer.update()
    diagnostics.run_checks()
    rows = scene.perception_entropy.result_warnings
    (found,) = [each for each in rows if each.code == "on_tail"]
    assert bpy.ops.pe.mend(fix=found.fix, amount=(*found.amount, 0, 0, 0)[:3]) == {"FINISHED"}
    bpy.context.view_layer.update()
    low, high = scenes.vehicle(scene.perception_entropy.vehicle).bounds
    assert tuple(low) == pytest.approx((-2.0, -0.9, 0.0), abs=1e-5), "centred, on the ground"
    assert tuple(high - low) == pytest.approx((4.0, 1.8, 1.3), abs=1e-5)


@pytest.mark.parametrize("quarter", [1, -1])
def test_a_mesh_of_z_up_imported_as_y_up_is_mended_by_one_button(car, quarter):
    """Wavefront's default axes lay it on its side, wheels at y = 0: 0.65 m beside its axis."""
    vehicle = car.perception_entropy.vehicle
    shape = scenes.vehicle(vehicle).bounds
    for obj in car.objects:
        obj.location.z -= 0.2  # the boxes begin 0.2 m above the ground
    bpy.context.view_layer.update()
    before = points_of(("body", "cabin", "roof"), car)
    for obj in car.objects:
        obj.matrix_world = Matrix.Rotation(quarter * math.pi / 2, 4, "X") @ obj.matrix_world
    bpy.context.view_layer.update()
    diagnostics.run_checks()
    rows = {row.code: row for row in car.perception_entropy.result_warnings}
    assert rows["not_centred"].fix == "move_vehicle"
    found = rows["on_side"]
    assert bpy.ops.pe.mend(fix=found.fix, amount=(*found.amount, 0, 0, 0)[:3]) == {"FINISHED"}
    for now, was in zip(points_of(("body", "cabin", "roof"), car), before, strict=True):
        assert now == pytest.approx(was, abs=1e-4)
    assert np.allclose(scenes.vehicle(vehicle).bounds, np.array(shape) - (0, 0, 0.2), atol=1e-5)
    diagnostics.run_checks()
    assert not [row.code for row in car.perception_entropy.result_warnings]


def test_an_arrow_ahead_of_the_vehicle_is_shown_until_there_is_a_sensor(scene):
    assert "front" not in scenes.drawn(scene)
    scenes.add_car(scene)
    bpy.context.view_layer.update()
    (shape,) = scenes.drawn(scene)["front"].values()
    assert shape.faces.points[:, 0].min() > 2.0 and abs(shape.faces.points[:, 1]).max() < 0.5
    labels = {tag.text: tag.place[0] for tag in shape.labels}
    assert labels["front"] > 2.0 and labels["rear"] < -2.0
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(-0.43, 0.0, 1.8))
    assert "front" not in scenes.drawn(scene)


def test_keys_are_added_and_all_of_them_removed(scene):
    keymap = bpy.context.window_manager.keyconfigs.new("test").keymaps.new(name="3D View")
    shortcuts.add_to(keymap)
    items = {(each.idname, each.type): each for each in keymap.keymap_items}
    assert len(items) == len(shortcuts.SHORTCUTS)
    toggled = items["wm.context_toggle", "L"].properties.data_path
    assert bpy.context.path_resolve(toggled) is False, "Live is a switch"
    assert all(each.ctrl and each.alt for (_, key), each in items.items() if key != "ESC")
    shortcuts.unregister()
    assert not keymap.keymap_items


def test_the_add_menu_has_each_kind_in_object_mode_alone(scene):
    menu = drawn(sensor_menus.PE_MT_add)
    assert menu.texts("operator") == [*(kind.label for kind in kinds.KINDS.values()), "Search..."]
    for mode, entries in (("OBJECT", ["PE_MT_add"]), ("EDIT_MESH", [])):
        layout = Layout()
        sensor_menus.draw_add_menu(SimpleNamespace(layout=layout), SimpleNamespace(mode=mode))
        assert layout.texts("menu") == entries


def first_panel():
    """What the first panel shows."""
    return drawn(main.main, **vars(Window(bpy.context.scene)))


@pytest.mark.parametrize("panels", ["SIMPLE", "ALL"])
def test_an_empty_file_shows_three_things(scene, panels):
    scene.perception_entropy.panels = panels
    assert [kind for kind, _ in first_panel().notes] == ["operator"] * 3
    window = Window(scene)
    shown = [cls for cls in CLASSES if issubclass(cls, bpy.types.Panel) and cls.poll(window)]
    assert [cls.__name__ for cls in shown] == ["PE_PT_main", "PE_PT_view"]
    scenes.add_car(scene)
    texts = first_panel().texts("operator")
    assert "pe.open_example" not in texts and "pe.score" in texts
    assert any("Then add a sensor" in text for text in first_panel().texts("label"))


@pytest.mark.parametrize("factor", [1e30, -1e30, 1e-30, 0.0, -1.0, math.nan, math.inf])
def test_a_scale_that_no_file_can_have_is_refused(car, factor):
    before = [obj.matrix_world.copy() for obj in bpy.data.objects]
    with pytest.raises(RuntimeError, match="mend: amount: expected a"):
        bpy.ops.pe.mend(fix="scale_vehicle", amount=(factor, 0.0, 0.0))
    bpy.context.view_layer.update()
    assert [obj.matrix_world for obj in bpy.data.objects] == before
