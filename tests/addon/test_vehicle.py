"""The vehicle as the engine gets it, against boxes that a hand can work out."""

import bpy
import numpy as np
import pytest

from blender_addon import document
from tests.addon import scenes
from tests.engine import surfaces

BOX_VOLUME = 8.0
BOX_TRIANGLES = 12


@pytest.fixture
def parts(scene):
    return scenes.add_collection(scene.collection, "Parts")


def bounds(vehicle):
    low, high = vehicle.bounds
    return [*low.tolist(), *high.tolist()]


def test_move_and_scale(parts):
    scenes.add_box(parts, "box", location=(10.0, 0.0, 1.0), scale=(2.0, 1.0, 0.5))
    vehicle = scenes.vehicle(parts)
    assert bounds(vehicle) == [8.0, -1.0, 0.5, 12.0, 1.0, 1.5]
    assert surfaces.volume(vehicle.triangles) == BOX_VOLUME


def test_negative_scale_keeps_faces_outwards(parts):
    scenes.add_box(parts, "box", scale=(-2.0, 1.0, 1.0))
    assert surfaces.volume(scenes.vehicle(parts).triangles) == 2.0 * BOX_VOLUME


def test_parent_moves_child_along(parts):
    parent = bpy.data.objects.new("parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.location = (5.0, 0.0, 0.0)
    parent.scale = (2.0, 2.0, 2.0)
    scenes.add_box(parts, "box", parent=parent, location=(1.0, 0.0, 0.0))
    assert bounds(scenes.vehicle(parts)) == [5.0, -2.0, -2.0, 9.0, 2.0, 2.0]


def test_modifier_is_applied(parts):
    box = scenes.add_box(parts, "box")
    array = box.modifiers.new("array", "ARRAY")
    array.count = 3
    array.relative_offset_displace = (2.0, 0.0, 0.0)
    vehicle = scenes.vehicle(parts)
    assert surfaces.volume(vehicle.triangles) == 3 * BOX_VOLUME
    assert bounds(vehicle) == [-1.0, -1.0, -1.0, 9.0, 1.0, 1.0]


def instance_of(collection, name, **settings):
    instance = bpy.data.objects.new(name, None)
    instance.instance_type = "COLLECTION"
    instance.instance_collection = collection
    for key, value in settings.items():
        setattr(instance, key, value)
    return instance


def test_collection_instances_are_made_real(parts):
    wheel = bpy.data.collections.new("Wheel")  # not in the scene but for its instances
    scenes.add_box(wheel, "tyre", location=(1.0, 0.0, 0.0))
    parts.objects.link(instance_of(wheel, "left", location=(0.0, 5.0, 0.0)))
    parts.objects.link(instance_of(wheel, "right", location=(0.0, -5.0, 0.0), scale=(1, -1, 1)))
    vehicle = scenes.vehicle(parts)
    assert vehicle.part_names == ("tyre",)
    assert surfaces.volume(vehicle.triangles) == 2 * BOX_VOLUME
    assert bounds(vehicle) == [0.0, -6.0, -1.0, 2.0, 6.0, 1.0]


def test_geometry_nodes_instances(parts):
    """A box on every corner of a box, and the box itself gone, as the node has it."""
    tree = bpy.data.node_groups.new("boxes", "GeometryNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=in_out, socket_type="NodeSocketGeometry")
    ends = [tree.nodes.new(f"NodeGroup{end}") for end in ("Input", "Output")]
    box, on_points = (tree.nodes.new(f"GeometryNode{n}") for n in ("MeshCube", "InstanceOnPoints"))
    tree.links.new(ends[0].outputs[0], on_points.inputs["Points"])
    tree.links.new(box.outputs["Mesh"], on_points.inputs["Instance"])
    tree.links.new(on_points.outputs[0], ends[1].inputs[0])
    scenes.add_box(parts, "bolts").modifiers.new("boxes", "NODES").node_group = tree
    vehicle = scenes.vehicle(parts)
    assert vehicle.part_names == ("bolts",)
    assert len(vehicle.triangles) == 8 * BOX_TRIANGLES
    assert bounds(vehicle) == [-1.5, -1.5, -1.5, 1.5, 1.5, 1.5]


@pytest.mark.parametrize("how", ["hide_viewport", "hide_render", "eye", "collection", "excluded"])
def test_hidden_does_not_count(parts, how):
    scenes.add_box(parts, "seen")
    inner = scenes.add_collection(parts, "Inner")
    hidden = scenes.add_box(inner, "hidden")
    layer = bpy.context.view_layer.layer_collection.children["Parts"].children["Inner"]
    if how == "eye":
        hidden.hide_set(True)
    elif how == "collection":
        inner.hide_render = True
    elif how == "excluded":
        layer.exclude = True
    else:
        setattr(hidden, how, True)
    assert scenes.vehicle(parts).part_names == ("seen",)


@pytest.mark.parametrize("how", ["object", "child", "collection", "nested", "surroundings"])
def test_what_is_hidden_in_an_instance_does_not_count(parts, how):
    """As Blender's renders show an instance: without its children that are hidden in renders."""
    kit = bpy.data.collections.new("Kit")  # not in the scene but for its instance
    child = scenes.add_collection(kit, "Child")
    rack = bpy.data.collections.new("Rack")
    scenes.add_box(kit, "seen")
    hidden = scenes.add_box(child, "hidden")
    scenes.add_box(rack, "bars")
    (child if how == "nested" else kit).objects.link(instance_of(rack, "rack"))
    parts.objects.link(instance_of(kit, "kit"))
    scenes.add_box(parts, "body")
    everything = {"seen", "hidden", "bars", "body"}
    assert set(scenes.vehicle(parts).part_names) == everything
    if how == "object":
        hidden.hide_render = True
    elif how == "surroundings":
        child[document.SURROUNDINGS] = True
    else:
        (kit if how == "collection" else child).hide_render = True
    left = {"collection": {"body"}, "nested": {"seen", "body"}}.get(how, everything - {"hidden"})
    assert set(scenes.vehicle(parts).part_names) == left


def test_curve_counts_once(parts):
    """Blender lists a curve twice, as itself and as its mesh."""
    curve = bpy.data.curves.new("bar", "CURVE")
    curve.dimensions = "3D"
    curve.extrude = 1.0
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[1].co = (4.0, 0.0, 0.0, 1.0)
    parts.objects.link(bpy.data.objects.new("bar", curve))
    vehicle = scenes.vehicle(parts)
    a, b, c = vehicle.triangles.transpose(1, 0, 2)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0
    assert vehicle.part_names == ("bar",)
    assert area == 8.0


def test_housing_of_a_sensor_is_not_the_vehicle(parts):
    scenes.add_box(parts, "roof")
    sensor = scenes.add_sensor("lidar", location=(0.0, 0.0, 3.0))
    scenes.add_box(parts, "housing", (0.1, 0.1, 0.1), parent=sensor)
    assert scenes.vehicle(parts).part_names == ("roof",)


def test_glass_is_named(parts):
    scenes.add_box(parts, "body")
    scenes.add_box(parts, "window").perception_entropy.see_through = True
    assert scenes.vehicle(parts).glass == ("window",)


def test_hidden_children_and_sensors_of_instances_are_told(car):
    """Sensors of an instanced collection cannot be placed: they are not scored, and named."""
    kit = bpy.data.collections.new("Kit")
    child = scenes.add_collection(kit, "Child")
    scenes.add_box(child, "hidden")
    sensor = scenes.add_sensor("inside", location=(0.0, 0.0, 2.0))
    scenes.add_sensor("roof", location=(0.0, 0.0, 2.0))
    for own in tuple(sensor.users_collection):
        own.objects.unlink(sensor)
    kit.objects.link(sensor)
    codes = {"hidden_vehicle", "instanced_sensors"}
    assert not [each for each in document.scene_advice(car) if each.code in codes]
    car.perception_entropy.vehicle.objects.link(instance_of(kit, "kit"))
    child.hide_render = True
    bpy.context.view_layer.update()
    told = {each.code: each.text for each in document.scene_advice(car) if each.code in codes}
    assert "Child is hidden in renders" in told["hidden_vehicle"]
    assert "inside" in told["instanced_sensors"] and "Kit" in told["instanced_sensors"]
