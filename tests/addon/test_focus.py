"""Focus weights and priors in the scene: the engine's own, whatever way they were chosen."""

import math

import bpy
import pytest

from blender_addon import document
from blender_addon.engine import formats, pe

INF = math.inf
CLASSES = ("car", "pedestrian", "cyclist", "truck", "cone")
LABELS = "class,x,y,z,length,width,height,yaw\ncar,20,3,0.8,4,2,1.6,0\ntram,-30,5,1.5,20,2.5,3,90\n"
IMPOSSIBLE = {
    "x: expected two numbers, low before high, found [5.0, 5.0]": {"x_range": (5.0, 5.0)},
    "y: expected two numbers, low before high, found [3.0, -2.5]": {"y_range": (3.0, -2.5)},
    "classes: expected at least one class, found none": {"classes": set()},
}


def add_focus(scene, region="front", **settings) -> bpy.types.PropertyGroup:
    """Return a new row of the list; settings are its properties."""
    assert bpy.ops.pe.add_row(rows="focus", kind=region) == {"FINISHED"}
    row = scene.perception_entropy.focus[-1]
    for key, value in settings.items():
        setattr(row, key, value)
    return row


@pytest.fixture
def labels(tmp_path):
    """Return a file of two labelled boxes, of a known class and of one of its own."""
    path = tmp_path / "labels.csv"
    path.write_text(LABELS)
    return path


def test_new_row_doubles_the_front_for_all_classes(scene):
    assert bpy.ops.pe.add_row(rows="focus") == {"FINISHED"}
    (row,) = scene.perception_entropy.focus
    assert (row.name, row.factor, row.region) == ("Focus 1", 2.0, "front")
    assert row.classes == set(CLASSES)
    assert document.prior_from_scene(scene).focus == (pe.Focus(2.0, x=(0.0, INF)),)


@pytest.mark.parametrize("message", IMPOSSIBLE)
def test_impossible_focus_is_one_line_that_names_it(car, message):
    add_focus(car)
    add_focus(car, "custom", name="Crossing", **IMPOSSIBLE[message])
    line = f"scene: focus 2 (Crossing): {message}"
    for operator in (bpy.ops.pe.score, bpy.ops.pe.optimize):
        with pytest.raises(RuntimeError) as refused:
            operator()
        assert str(refused.value).strip() == f"Error: {line}"
    assert not car.perception_entropy.has_result and document.fingerprint(car).text


def test_labelled_boxes(scene, labels):
    settings = scene.perception_entropy
    settings.prior = "boxes"
    settings.boxes = str(labels)
    add_focus(scene, "front")
    prior = document.prior_from_scene(scene)
    assert prior == pe.Prior.from_boxes(formats.read_boxes(labels), [pe.Focus(2.0, x=(0.0, INF))])
    assert prior.class_names == ("car", "tram")
