"""Focus weights and priors in the scene: the engine's own, whatever way they were chosen."""

import math

import bpy
import pytest

from blender_addon import bridge, choices, result_staleness
from blender_addon.engine import formats, pe
from tests.addon import scenes

INF = math.inf
CLASSES = ("car", "pedestrian", "cyclist", "truck", "cone")
ALL = (-INF, INF)
AREAS = {
    "everywhere": [(ALL, ALL)],
    "front": [((0.0, INF), ALL)],
    "rear": [((-INF, 0.0), ALL)],
    "left": [(ALL, (0.0, INF))],
    "right": [(ALL, (-INF, 0.0))],
    "far": [((-INF, -40.0), ALL), ((40.0, INF), ALL)],
    "custom": [((-80.0, 80.0), (-40.0, 40.0))],
}
LABELS = "class,x,y,z,length,width,height,yaw\ncar,20,3,0.8,4,2,1.6,0\ntram,-30,5,1.5,20,2.5,3,90\n"


def add_focus(scene, region="front", **settings) -> bpy.types.PropertyGroup:
    """Return a new row of the list; settings are its properties."""
    assert bpy.ops.pe.add_focus(region=region) == {"FINISHED"}
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
    assert bpy.ops.pe.add_focus() == {"FINISHED"}
    (row,) = scene.perception_entropy.focus
    assert (row.name, row.factor, row.region) == ("Focus 1", 2.0, "front")
    assert row.classes == set(CLASSES)
    assert bridge.prior_from_scene(scene).focus == (pe.Focus(2.0, x=(0.0, INF)),)


def test_every_region_is_tested():
    assert list(AREAS) == list(choices.REGIONS)


@pytest.mark.parametrize("region", AREAS)
def test_region_is_the_engines_focus(scene, region):
    add_focus(scene, region, factor=0.5)
    expected = tuple(pe.Focus(0.5, x, y) for x, y in AREAS[region])
    assert bridge.prior_from_scene(scene).focus == expected


def test_classes_come_in_the_engines_order(scene):
    add_focus(scene, classes={"cone", "pedestrian"})
    (focus,) = bridge.prior_from_scene(scene).focus
    assert focus.classes == ("pedestrian", "cone")


def test_rows_stay_in_order_and_multiply(scene):
    add_focus(scene, "far", factor=2.0)
    add_focus(scene, "front", factor=3.0, classes={"car"})
    prior = bridge.prior_from_scene(scene)
    assert [f.factor for f in prior.focus] == [2.0, 2.0, 3.0]
    space = pe.PerceptionSpace(interval=5.0)
    plain, weighed = (
        {d.name: d.ground for d in p.densities(space)} for p in (pe.Prior.road(), prior)
    )
    ratios = weighed["car"] / plain["car"]
    rear, front, far_front = (ratios[i, 0] / ratios[15, 0] for i in (15, 16, space.shape[0] - 1))
    assert (rear, front, far_front) == pytest.approx((1.0, 3.0, 6.0))
    assert (weighed["cone"] / plain["cone"])[0, 0] / ratios[15, 0] == pytest.approx(2.0)


@pytest.mark.parametrize("model", ["road", "highway", "uniform"])
def test_prior_is_the_engines(scene, model):
    scene.perception_entropy.prior = model
    add_focus(scene, "rear")
    focus = [pe.Focus(2.0, x=(-INF, 0.0))]
    assert bridge.prior_from_scene(scene) == getattr(pe.Prior, model)(focus)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"region": "custom", "x_range": (5.0, 5.0)},
            "x: expected two numbers, low before high, found [5.0, 5.0]",
        ),
        (
            {"region": "custom", "y_range": (3.0, -2.5)},
            "y: expected two numbers, low before high, found [3.0, -2.5]",
        ),
        ({"classes": set()}, "classes: expected at least one class, found none"),
    ],
)
def test_impossible_focus_is_one_line_that_names_it(car, settings, message):
    add_focus(car)
    add_focus(car, name="Crossing", **settings)
    line = f"scene: focus 2 (Crossing): {message}"
    with pytest.raises(pe.InputError) as caught:
        scenes.study()
    assert str(caught.value) == line
    for operator in (bpy.ops.pe.score, bpy.ops.pe.optimize):
        with pytest.raises(RuntimeError) as refused:
            operator()
        assert str(refused.value).strip() == f"Error: {line}"
    assert not car.perception_entropy.has_result
    assert bridge.signature(car)  # also then there is one


def test_classes_that_the_prior_does_not_have(scene):
    add_focus(scene, classes={"pedestrian", "car"})
    scene.perception_entropy.prior = "uniform"
    with pytest.raises(pe.InputError, match=r"focus 1 \(Focus 1\): classes: expected all classes"):
        bridge.prior_from_scene(scene)
    scene.perception_entropy.prior = "highway"
    with pytest.raises(pe.InputError, match=r"expected some of car, truck.*, found pedestrian"):
        bridge.prior_from_scene(scene)


def test_labelled_boxes(scene, labels):
    settings = scene.perception_entropy
    settings.prior, settings.boxes = "boxes", str(labels)
    add_focus(scene, "front")
    prior = bridge.prior_from_scene(scene)
    assert prior == pe.Prior.from_boxes(formats.read_boxes(labels), [pe.Focus(2.0, x=(0.0, INF))])
    assert prior.class_names == ("car", "tram")


@pytest.mark.parametrize(
    ("name", "found"),
    [("", "scene: boxes: expected a file of labelled boxes"), ("no.csv", "no.csv")],
)
def test_labelled_boxes_without_a_file_are_an_error(car, tmp_path, name, found):
    settings = car.perception_entropy
    settings.prior, settings.boxes = "boxes", str(tmp_path / name) if name else ""
    with pytest.raises(RuntimeError, match=found) as caught:
        bpy.ops.pe.score()
    assert len(str(caught.value).strip().splitlines()) == 1


def test_result_goes_stale_and_comes_back(car):
    settings = car.perception_entropy
    row = add_focus(car, "custom")
    bpy.ops.pe.score()
    changes = (("factor", 3.0), ("region", "rear"), ("x_range", (0.0, 9.0)))
    changes += (("y_range", (0.0, 9.0)), ("classes", {"car"}))
    for name, value in changes:
        before = getattr(row, name)
        before = tuple(before) if name.endswith("range") else before
        for new, expected in ((value, True), (before, False)):
            setattr(row, name, new)
            result_staleness.update_result()
            assert settings.result_stale == expected, (name, new)
    row.name = "another"
    result_staleness.update_result()
    assert not settings.result_stale
    bpy.ops.pe.add_focus()
    result_staleness.update_result()
    assert settings.result_stale
    bpy.ops.pe.remove_focus()
    result_staleness.update_result()
    assert not settings.result_stale


def test_bounds_that_are_not_used_do_not_matter(scene):
    row = add_focus(scene, "front")
    before = bridge.signature(scene)
    row.x_range = (1.0, 2.0)
    assert bridge.signature(scene) == before


def test_boxes_are_part_of_the_signature_when_they_are_used(scene):
    settings = scene.perception_entropy
    road = bridge.signature(scene)
    settings.boxes = "a.csv"
    assert bridge.signature(scene) == road
    settings.prior = "boxes"
    first = bridge.signature(scene)
    settings.boxes = "b.csv"
    assert len({road, first, bridge.signature(scene)}) == 3


def test_remove_takes_the_selected_row(scene):
    settings = scene.perception_entropy
    for _ in range(3):
        bpy.ops.pe.add_focus()
    assert settings.focus_index == 2
    settings.focus_index = 1
    assert bpy.ops.pe.remove_focus() == {"FINISHED"}
    assert [row.name for row in settings.focus] == ["Focus 1", "Focus 3"]
    assert settings.focus_index == 1
    bpy.ops.pe.add_focus()
    assert [row.name for row in settings.focus] == ["Focus 1", "Focus 3", "Focus 2"]
    for left in (1, 0, 0):
        bpy.ops.pe.remove_focus()
        assert settings.focus_index == left
    assert not bpy.ops.pe.remove_focus.poll()
    with pytest.raises(RuntimeError, match="No focus is selected"):
        bpy.ops.pe.remove_focus()
