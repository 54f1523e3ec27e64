"""Another variant beside the scene, and the place that was asked about, as arrays."""

import bpy
import numpy as np
import pytest

from blender_addon.engine import advice, catalog, pe
from blender_addon.overlay import layers
from blender_addon.overlay.annotations import OCCLUDED, VISIBLE, location_mark
from tests.addon import scenes


def sensor(name, x, model="Pandar64"):
    return pe.Sensor(name, catalog.load(model), pe.Pose((x, 0.0, 1.8)))


def segments(shape):
    """Lines as (N, 2, 3) ends."""
    return shape.through.points.reshape(-1, 2, 3)


def joins(shape, start, end):
    """Whether one of the lines goes from a point to another."""
    ends = np.array([start, end], np.float32)
    return bool((np.abs(segments(shape) - ends).max(axis=(1, 2)) < 1e-6).any())


def test_lines_tell_who_sees_the_place_and_from_whom_it_is_hidden():
    def told(name, m, reason):
        return advice.SensorAtPlace(
            name, "lidar", m, unhidden=5.0, ap=0.5, occluded_by=None, reason=reason
        )

    seen = (told("a", 3.0, "sees"), told("b", 0.0, "occluded"), told("c", 0.0, "out of view"))
    place = advice.AskedPlace(
        (5.0, 1.0, 0.05),
        entropy=1.0,
        ap=0.5,
        seen=True,
        density=1.0,
        in_vehicle=False,
        sensors=seen,
    )
    shape = location_mark(place, [sensor(name, float(k)) for k, name in enumerate("abc")])
    for k, color in ((0, VISIBLE), (1, OCCLUDED)):
        assert joins(shape, (float(k), 0.0, 1.8), place.center)
        own = np.float32(color)
        assert (np.abs(shape.through.colors - own).max(axis=1) < 1e-6).sum() == 2
    assert not joins(shape, (2.0, 0.0, 1.8), place.center)
    assert shape.labels[0].text == "seen by 1, AP 0.50"
    low = segments(shape)[:12].reshape(-1, 3)  # the voxel's edges
    np.testing.assert_allclose(low.min(axis=0), (4.95, 0.95, 0.0), atol=1e-6)
    np.testing.assert_allclose(low.max(axis=0), (5.05, 1.05, 0.1), atol=1e-6)


@pytest.fixture
def two(car):
    """The car with a variant to be shown beside it, and the view on."""
    bpy.ops.pe.save_variant()
    car.objects["roof"].location.z = 2.4
    bpy.context.view_layer.update()
    return car


def test_the_scene_shows_the_variant_whose_ghost_is_on(two):
    key = two.perception_entropy.variants[0].key
    assert "ghosts" not in scenes.drawn(two)
    bpy.ops.pe.ghost_variant(key=key)
    shape = scenes.drawn(two)["ghosts"][layers.WHOLE_RIG]
    assert joins(shape, (-0.43, 0.0, 1.8), (-0.43, 0.0, 2.4))
    assert not len(shape.lines.points)
    two.perception_entropy.view.show_reach = True
    assert len(scenes.drawn(two)["ghosts"][layers.WHOLE_RIG].lines.points), "its reach as well"
    bpy.ops.pe.ghost_variant(key=key)
    assert "ghosts" not in scenes.drawn(two)
    bpy.ops.pe.ghost_variant(key=key)
    bpy.ops.pe.remove_row(rows="variants")
    assert "ghosts" not in scenes.drawn(two)


def test_a_wipe_shows_the_ground_of_both_variants_as_each_alone_is_shown(two):
    (row,) = two.perception_entropy.variants
    view = two.perception_entropy.view
    view.show_ground = view.show_blind = view.show_reach = view.wipe = True
    before = scenes.drawn(two)
    assert set(before["blind"]) == {layers.WHOLE_RIG}, "no other variant is shown"
    bpy.ops.pe.ghost_variant(key=row.key)
    both = scenes.drawn(two)
    bpy.ops.pe.ghost_variant(key=row.key)
    bpy.ops.pe.switch_variant(key=row.key)
    after = scenes.drawn(two)
    for layer in ("blind", "reach"):
        for name, alone in ((layers.WHOLE_RIG, before), (layers.OTHER_RIG, after)):
            wanted = alone[layer][layers.WHOLE_RIG].lines
            found = both[layer][name].lines
            assert np.array_equal(found.points, wanted.points)
    maps = [both["ground"][name] for name in (layers.WHOLE_RIG, layers.OTHER_RIG)]
    assert maps[0].legend == maps[1].legend, "both in the same colours"
    assert not np.array_equal(maps[0].sheet.mesh[1], maps[1].sheet.mesh[1])
