"""Positions as distances from edges of the vehicle: panel, scene, study file and command."""

import json

import bpy
import pytest

import pe_core as pe
import pe_tools as pt
from blender_addon import document
from tests.addon import scenes
from tests.addon.command_line import run_here

# The car of `scenes`: body x +-2, y +-0.9; cabin x -1.3 to 0.7, y +-0.8, z 0.9 to 1.5.


@pytest.fixture
def roof(car):
    """Return the settings of the LiDAR at (-0.43, 0, 1.8), told from the cabin."""
    own = bpy.data.objects["roof"].perception_entropy
    own.edge_x = "cabin front"
    own.edge_y = "center line"
    return own


def position(name="roof"):
    bpy.context.view_layer.update()
    return document.pose_of(bpy.data.objects[name], scenes.depsgraph()).position


def select_in_edit_mode(obj, chosen):
    """Select the vertices of a mesh that are chosen by their coordinates."""
    for other in bpy.context.view_layer.objects:
        other.select_set(other == obj)
    bpy.context.view_layer.objects.active = obj
    for vertex in obj.data.vertices:
        vertex.select = chosen(vertex.co)
    for each in (*obj.data.edges, *obj.data.polygons):
        each.select = all(obj.data.vertices[k].select for k in each.vertices)
    bpy.ops.object.mode_set(mode="EDIT")


def test_the_panel_shows_how_far_a_sensor_is_from_its_edges(roof):
    assert list(roof.edge_distances) == pytest.approx([1.13, 0.0, 0.0])
    bpy.data.objects["roof"].location.y = -0.2
    assert position()[1] == -0.2
    assert list(roof.edge_distances) == pytest.approx([1.13, 0.2, 0.0])


def test_a_typed_distance_moves_the_sensor_and_no_other_coordinate(roof):
    roof.edge_distances = (0.35, 0.12, 5.0)  # no edge of the height: it stays
    assert position() == (0.35, 0.12, 1.8)
    roof.edge_distances[0] = -0.1  # on the other side: ahead of the cabin's front
    assert position() == (0.8, 0.12, 1.8)


def test_an_edge_is_named_of_vertices_in_edit_mode_and_told_from_where_it_is_moved(car):
    cabin = bpy.data.objects["cabin"]
    select_in_edit_mode(cabin, lambda co: co.x > 0 and co.z > 0)
    assert bpy.ops.pe.name_edge(name="screen") == {"FINISHED"}
    bpy.ops.object.mode_set(mode="OBJECT")
    (edge,) = scenes.study().edges
    assert sorted(edge.points) == [(0.7, -0.8, 1.5), (0.7, 0.8, 1.5)]
    own = bpy.data.objects["roof"].perception_entropy
    own.edge_x = "screen"
    own.edge_z = "screen"
    assert list(own.edge_distances) == pytest.approx([1.13, 0.0, 0.3])
    line = next(obj for obj in bpy.data.objects if obj.perception_entropy.edge_name == "screen")
    line.location.x = 0.5
    bpy.context.view_layer.update()
    assert list(own.edge_distances) == pytest.approx([1.63, 0.0, 0.3])
    assert len(scenes.study().vehicle.part_names) == 2  # it is no part of the vehicle


def test_a_curve_beside_the_vehicle_is_an_edge(car):
    curve = bpy.data.curves.new("seam", "CURVE")
    curve.dimensions = "3D"
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    for point, place in zip(spline.points, ((0, -1, 0.5), (0, 1, 0.5)), strict=True):
        point.co = (*place, 1.0)
    obj = bpy.data.objects.new("seam", curve)
    car.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    assert bpy.ops.pe.name_edge(name="seam") == {"FINISHED"}
    assert scenes.study().vehicle_edges.at("seam", "x", (0, 0, 0)) == 0.0
    assert scenes.study().vehicle_edges.at("seam", "z", (0, 0, 0)) == 0.5


def test_nothing_that_is_no_edge_is_named(car):
    body = bpy.data.objects["body"]
    bpy.context.view_layer.objects.active = body
    assert bpy.ops.pe.name_edge(name="all") == {"CANCELLED"}  # the vehicle itself
    select_in_edit_mode(body, lambda co: co.x > 0 and co.y > 0 and co.z > 0)
    assert bpy.ops.pe.name_edge(name="dot") == {"CANCELLED"}  # one vertex
    bpy.ops.object.mode_set(mode="OBJECT")
    assert not scenes.study().edges


def test_a_scene_and_its_study_file_tell_the_same_edges_and_bits(roof, car, tmp_path):
    document.add_edge(car, pe.Edge("seam", [(0.1, -1.0, 1.2), (0.3, 1.0, 1.2)]))
    bpy.context.view_layer.update()
    roof.edge_x = "seam"
    roof.edge_distances = (0.45, 0.07, 0.0)
    study = scenes.study()
    pt.export_study(study, tmp_path / "study.toml")
    again = pe.load_study(tmp_path / "study.toml")
    assert again.edges == study.edges
    assert again.rig["roof"].pose == study.rig["roof"].pose
    assert again.distances(again.rig["roof"]) == study.distances(study.rig["roof"])
    assert pt.jobs.fingerprint(again) == pt.jobs.fingerprint(study)
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    lines = document.load_into(bpy.context.scene, again)
    assert lines == []
    held = scenes.study()
    assert held.edges == study.edges
    assert held.rig["roof"].pose == study.rig["roof"].pose
    assert held.distances(held.rig["roof"]) == study.distances(study.rig["roof"])


def test_all_variants_of_a_sensor_are_told_from_its_edges(roof):
    settings = bpy.context.scene.perception_entropy
    bpy.ops.pe.save_variant()
    bpy.data.objects["roof"].location.x = 0.0
    bpy.ops.pe.save_variant()
    roof.edge_x = "cabin rear"
    bpy.ops.pe.switch_variant(key=settings.variants[0].key)
    assert position() == (-0.43, 0.0, 1.8)
    assert roof.edge_x == "cabin rear"
    assert roof.edge_distances[0] == pytest.approx(0.87)


def test_the_command_tells_and_takes_distances_of_a_blend_file(roof, tmp_path):
    blend = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    words = ("explain", "--sensor", "roof", "--from", "cabin front", "ground", "--json")
    found = run_here(blend, words)
    assert found.returncode == 0
    distances = json.loads(found.stdout)["distances"]
    assert distances == ["1.13 m behind cabin front", "1.8 m above ground"]
    typed = 'sensor.roof.position=["0.5 m behind cabin front", 0, "0.3 m above cabin top"]'
    found = run_here(blend, ["score", "--json", "--set", typed])
    assert found.returncode == 0
    placed = json.loads(found.stdout)["placements"]["after"]["roof"]
    assert placed["position"] == pytest.approx([0.2, 0.0, 1.8])
    assert placed["distances"] == ["0.5 m behind cabin front", "0.3 m above cabin top"]
