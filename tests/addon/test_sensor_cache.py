"""A scene is looked through for its sensors once a need, however large it is."""

import sys

import bpy
import pytest

from blender_addon.caches import result_staleness, sensor_cache
from blender_addon.caches.sensor_cache import sensors as listed_sensors
from blender_addon.document.rig import sensor_objects
from blender_addon.overlay.snapshot import SnapshotReader

OTHERS = 2000


@pytest.fixture
def crowd(car):
    """The car with its LiDAR among many other objects."""
    for number in range(OTHERS):
        car.collection.objects.link(bpy.data.objects.new(f"thing {number}", None))
    bpy.context.view_layer.update()
    return car


@pytest.fixture
def looks():
    """Return a function that counts how often a piece of work looks through a scene."""

    def count(work) -> int:
        calls = []

        def note(frame, event, _argument):
            if event == "call" and frame.f_code is sensor_objects.__code__:
                calls.append(frame)

        sys.setprofile(note)
        try:
            work()
        finally:
            sys.setprofile(None)
        return len(calls)

    return count


def draw(scene, cache):
    """What a redraw of panel and 3D view asks for."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shown = cache.request(scene, depsgraph).sensors
    return [obj.name for obj in listed_sensors(scene)], [each.sensor.name for each in shown]


def test_a_score_looks_once_before_the_work_and_once_after(crowd, looks):
    assert looks(bpy.ops.pe.score) == 2  # four times before there was this test


def test_redraws_without_a_change_look_once(crowd, looks):
    cache = SnapshotReader()

    bpy.ops.pe.score()

    def work():
        for _ in range(10):
            assert draw(crowd, cache) == (["roof"], ["roof"])
        result_staleness.update_result()

    sensor_cache.invalidate()
    assert looks(work) == 1  # twenty-one times before
    assert looks(work) == 0


def test_a_change_is_seen_at_the_next_redraw(car):
    cache = SnapshotReader()
    assert draw(car, cache)[0] == ["roof"]
    copy = car.objects["roof"].copy()
    copy.name = "copy"
    car.collection.objects.link(copy)
    bpy.context.view_layer.update()
    assert draw(car, cache) == (["copy", "roof"],) * 2
    copy.name = "zenith"
    bpy.context.view_layer.update()
    assert draw(car, cache) == (["roof", "zenith"],) * 2
    copy.perception_entropy.is_sensor = False
    assert draw(car, cache) == (["roof"],) * 2
    bpy.data.objects.remove(car.objects["roof"])
    assert draw(car, cache) == ([], [])
    copy.perception_entropy.is_sensor = True
    assert draw(car, cache)[0] == ["zenith"]
