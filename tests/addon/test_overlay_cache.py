"""The overlay rebuilds what changed and nothing else, and leaves no handler behind."""

import pytest

bpy = pytest.importorskip("bpy")

import blender_addon  # noqa: E402
from blender_addon import body, bridge  # noqa: E402
from blender_addon.overlay import handler  # noqa: E402
from blender_addon.overlay.cache import OverlayCache  # noqa: E402


@pytest.fixture
def scene():
    """A box for a car with a LiDAR and a camera."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    blender_addon.register()
    found = bpy.context.scene
    car = bpy.data.collections.new("Car")
    found.collection.children.link(car)
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(0, 0, 0.9), scale=(4.4, 1.8, 1.2))
    body = bpy.context.object
    found.collection.objects.unlink(body)
    car.objects.link(body)
    body.name = "body"
    found.perception_entropy.vehicle = car
    for name, model, place in (("a", "Pandar40", (0, 0, 1.9)), ("b", "Camera 60 deg", (2, 0, 1.6))):
        sensor = bpy.data.objects.new(name, None)
        sensor.location = place
        found.collection.objects.link(sensor)
        sensor.perception_entropy.is_sensor, sensor.perception_entropy.model = True, model
    yield found
    blender_addon.unregister()


def update(cache, scene):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    depsgraph.update()
    return cache.update(scene, depsgraph)


def test_nothing_is_rebuilt_without_a_change(scene):
    cache = OverlayCache()
    first, second = update(cache, scene), update(cache, scene)
    assert set(first) == {"a", "b"}
    assert all(first[name] is second[name] for name in first)


def test_a_moved_sensor_is_rebuilt_alone(scene, monkeypatch):
    cache = OverlayCache()
    before = update(cache, scene)
    monkeypatch.setattr(bridge, "vehicle_from_collection", lambda *_: pytest.fail("read again"))
    scene.objects["a"].location.z += 0.1
    after = update(cache, scene)
    assert after["a"] is not before["a"] and after["b"] is before["b"]


def test_a_moved_vehicle_is_noticed(scene):
    seen = []

    def watch(of_scene, depsgraph):
        seen.append(body.touched(of_scene, depsgraph))

    bpy.app.handlers.depsgraph_update_post.append(watch)
    try:
        scene.objects["a"].location.x += 0.1
        bpy.context.view_layer.update()
        assert seen and not any(seen)
        scene.objects["body"].location.x += 0.1
        bpy.context.view_layer.update()
        assert seen[-1]
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(watch)


def test_settings_count(scene):
    cache = OverlayCache()
    scene.perception_entropy.beam_limit = 100
    assert len(update(cache, scene)["a"].lines.points) <= 200
    scene.objects["a"].perception_entropy.show = False
    assert set(update(cache, scene)) == {"b"}
    scene.objects["b"].perception_entropy.model = "no such model"
    assert update(cache, scene) == {}


def test_without_a_vehicle_no_beam_is_stopped(scene):
    cache = OverlayCache()
    colors = {tuple(color) for color in update(cache, scene)["a"].lines.colors[:, :3].tolist()}
    scene.perception_entropy.vehicle = None
    free = {tuple(color) for color in update(cache, scene)["a"].lines.colors[:, :3].tolist()}
    assert len(colors) == 2 and len(free) == 1 and free < colors


def test_register_and_unregister_leave_nothing(scene):
    lists = [getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)]
    lists = [each for each in lists if isinstance(each, list)]
    handler.unregister()
    counts = [len(each) for each in lists]
    handler.register()
    handler.register()
    handler.unregister()
    handler.unregister()
    assert [len(each) for each in lists] == counts
    handler.register()  # as the add-on's own unregister expects
