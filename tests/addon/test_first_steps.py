"""The first minute: a vehicle from what is selected, an example, and what the empty tab says."""

import math
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from blender_addon.panels import CLASSES, main
from blender_addon.queries import diagnostics
from tests.addon import scenes
from tests.addon.layouts import Window, drawn


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
    shell = scenes.add_box(imported, "shell")
    wheel = scenes.add_box(imported, "wheel")
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


def test_sensors_and_their_housings_are_no_parts(car):
    roof = car.objects["roof"]
    select(roof)
    with pytest.raises(RuntimeError, match="found roof"):
        bpy.ops.pe.use_selected()
    select(roof, car.objects["body"], car.objects["cabin"])
    bpy.ops.pe.use_selected()
    assert vehicle().name == "Car", "the collection that has both parts"


def points_of(names, scene):
    """Return the centres of objects, in the ground frame, rounded [m]."""
    bpy.context.view_layer.update()
    return [tuple(round(c, 5) for c in scene.objects[n].matrix_world.translation) for n in names]


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
    assert bpy.ops.pe.fix_warning(fix=found.fix, amount=(*found.amount, 0, 0, 0)[:3]) == {
        "FINISHED"
    }
    for now, was in zip(points_of(("body", "cabin", "roof"), car), before, strict=True):
        assert now == pytest.approx(was, abs=1e-4)
    assert np.allclose(scenes.vehicle(vehicle).bounds, np.array(shape) - (0, 0, 0.2), atol=1e-5)
    diagnostics.run_checks()
    assert not [row.code for row in car.perception_entropy.result_warnings]


def first_panel():
    """What the first panel shows."""
    return drawn(main.main, **vars(Window(bpy.context.scene)))


@pytest.mark.parametrize("panels", ["SIMPLE", "ALL"])
def test_an_empty_file_shows_two_things(scene, panels):
    scene.perception_entropy.panels = panels
    assert [kind for kind, _ in first_panel().notes] == ["operator"] * 2
    window = Window(scene)
    shown = [cls for cls in CLASSES if issubclass(cls, bpy.types.Panel) and cls.poll(window)]
    assert [cls.__name__ for cls in shown] == ["PE_PT_main", "PE_PT_view"]
    scenes.add_car(scene)
    texts = first_panel().texts("operator")
    assert "pe.open_example" not in texts and "pe.score" in texts
    assert any("Then add a sensor" in text for text in first_panel().texts("label"))
