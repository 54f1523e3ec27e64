"""Words and warnings in the panel, the place that is asked about, and what fixes what is odd."""

import math

import bpy
import numpy as np
import pytest

from blender_addon import document
from blender_addon.engine import advice
from blender_addon.queries import diagnostics, location_query
from tests.addon import scenes


def told(scene):
    """What is odd, by whose it is: (subject, code)."""
    diagnostics.run_checks()
    return [(row.subject or "", row.code) for row in scene.perception_entropy.result_warnings]


def fix(scene, code):
    """Press the button of a warning."""
    diagnostics.run_checks()
    rows = scene.perception_entropy.result_warnings
    row = next(each for each in rows if each.code == code)
    amount = (*row.amount, 0.0, 0.0, 0.0)[:3]
    done = bpy.ops.pe.fix_warning(fix=row.fix, subject=row.subject or "", amount=amount)
    bpy.context.view_layer.update()
    return done


def bounds(scene):
    return document.vehicle_from_collection(
        scene.perception_entropy.vehicle, scenes.depsgraph()
    ).bounds


def carry(scene, change):
    """Do something to every part of the vehicle."""
    for obj in scene.perception_entropy.vehicle.all_objects:
        change(obj)
    bpy.context.view_layer.update()


def test_a_sunk_vehicle_is_lifted_with_the_sensor_on_it(car):
    car.objects["roof"].location.z = 1.3

    def sink(obj):
        obj.location.z -= 0.5

    carry(car, sink)
    assert ("", "height") in told(car)
    assert fix(car, "height") == {"FINISHED"}
    assert bounds(car)[0][2] == pytest.approx(0.0, abs=1e-5)  # the lowest box's underside
    assert car.objects["roof"].location.z == pytest.approx(1.6, abs=1e-5)
    assert ("", "height") not in told(car)


def test_a_vehicle_that_lies_along_y_is_turned_with_the_sensor_on_it(car):
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

    def left(obj):
        obj.location = turn @ np.array(obj.location)
        obj.rotation_euler.z = math.pi / 2

    carry(car, left)
    assert ("", "faces") in told(car)
    before = np.array(car.objects["roof"].location)
    fix(car, "faces")
    low, high = bounds(car)
    assert high[0] - low[0] == pytest.approx(4.0, abs=1e-4)
    np.testing.assert_allclose(car.objects["roof"].location, turn @ before, atol=1e-5)
    assert ("", "faces") not in told(car)


def test_a_place_is_asked_as_the_engine_does(car):
    assert bpy.ops.pe.ask_place(point=(6.0, 3.0, 0.0)) == {"FINISHED"}
    study = scenes.study()
    expected = advice.ask_place(
        study.rig, study.space, study.prior, study.vehicle, point=(6.0, 3.0, 0.0)
    )
    found = location_query.answer(car)
    assert found.lines == expected.text and found.place.sensors == expected.sensors
    car.objects["roof"].location.z = 2.4
    bpy.context.view_layer.update()
    location_query.query_again()
    assert location_query.answer(car).lines != expected.text
    bpy.ops.pe.dismiss(answer="QUERY")
    assert location_query.answer(car) is None


def lost_roof(tmp_path):
    """Open a car whose cabin is another file's, and that file is gone."""
    cabin = bpy.data.objects["cabin"]
    library = tmp_path / "library.blend"
    bpy.data.libraries.write(str(library), {cabin})
    car = bpy.data.collections["Car"]
    bpy.data.objects.remove(cabin)
    with bpy.data.libraries.load(str(library), link=True) as (_, wanted):
        wanted.objects = ["cabin"]
    car.objects.link(bpy.data.objects["cabin"])
    path = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path), relative_remap=False)
    whole = scenes.study().evaluator().score(scenes.study().rig).entropy
    library.unlink()
    bpy.ops.wm.open_mainfile(filepath=str(path))
    return path, whole


def test_a_lost_library_is_reported_by_name_and_marks_the_result(car, tmp_path):
    _, whole = lost_roof(tmp_path)
    scene = bpy.context.scene
    assert ("", "missing") in told(scene)
    bpy.ops.pe.score()
    settings = scene.perception_entropy
    assert "cabin is missing" in settings.result.missing[0]
    assert "library.blend" in settings.result.missing[0]
    assert settings.result.entropy != pytest.approx(whole, abs=1e-6), "nothing was missing"
    assert '"code": "missing"' in settings.result_json


def hide_it(layer):
    layer.hide_viewport = True


def exclude_it(layer):
    layer.exclude = True


def hide_in_renders(layer):
    layer.collection.hide_render = True


@pytest.mark.parametrize(
    ("hide", "told"),
    [(exclude_it, "excluded from"), (hide_it, "in the viewport"), (hide_in_renders, "in renders")],
)
def test_a_vehicle_that_is_out_of_the_view_is_reported_by_name_and_can_be_shown(car, hide, told):
    layer = bpy.context.view_layer.layer_collection.children["Car"]
    assert not [each for each in document.scene_advice(car) if each.code == "hidden_vehicle"]
    hide(layer)
    bpy.context.view_layer.update()
    (advice,) = [each for each in document.scene_advice(car) if each.code == "hidden_vehicle"]
    assert "Car is" in advice.text and told in advice.text
    assert bpy.ops.pe.fix_warning(fix=advice.fix) == {"FINISHED"}
    assert scenes.study().vehicle is not None
    assert not [each for each in document.scene_advice(car) if each.code == "hidden_vehicle"]
