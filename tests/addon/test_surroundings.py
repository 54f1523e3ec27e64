"""The road and the test bodies round the vehicle: drawn, grabbed and counted, never scored."""

import bpy

from blender_addon.panels.score_details import surroundings
from blender_addon.queries import body_query
from tests.addon import scenes
from tests.addon.command_line import same_in_both
from tests.addon.layouts import Window, drawn


def test_a_grabbed_body_is_counted_as_pe_does_and_nothing_else_notices(car, tmp_path):
    scenes.add_sensor("eye", "Camera 60 deg", location=(2.0, 0.0, 1.0))
    before = scenes.study()
    objects = set(bpy.data.objects)
    assert bpy.ops.pe.surroundings() == {"FINISHED"}
    car.perception_entropy.vehicle.children.link(bpy.data.collections["Surroundings"])
    assert len(scenes.study().vehicle.triangles) == len(before.vehicle.triangles)
    assert {"child", "adult", "cyclist", "car", "pole", "cone"} == set(body_query.seen(car))

    child = car.objects["child"]
    child.location = (9.1, 0.7, 0.0)
    child.rotation_euler.z = 0.3
    bpy.context.view_layer.update()
    body_query.query(car, scenes.depsgraph())
    body = body_query.seen(car)["child"]
    assert [each.name for each in body.seeing] == ["eye", "roof"]
    (label,) = (each for each in body_query.labels(car, child) if each.text.startswith("child"))
    assert label.text.split("\n")[1:] == [f"{each.name}: {each.text}" for each in body.seeing]
    told = drawn(surroundings, **vars(Window(car, child))).texts("label")
    assert {each.text for each in body.seeing} <= set(told)

    standing = body.standing
    asked = ["--at", *map(repr, standing.place), "--heading", repr(standing.heading)]
    told = same_in_both(tmp_path, "explain", [*asked, "--body", "child"])
    assert told["body"] == body.to_dict()

    assert bpy.ops.pe.surroundings() == {"FINISHED"}
    assert len(bpy.data.objects) == len(objects) and not body_query.seen(bpy.context.scene)
