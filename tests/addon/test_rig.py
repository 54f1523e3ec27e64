"""Sensors of the scene to a rig and back, to the bit."""

import math

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from blender_addon import document
from blender_addon.engine import pe, search
from tests.addon import scenes

POSES = 200


def read(obj) -> pe.Pose:
    return document.pose_of(obj, scenes.depsgraph())


def random_poses(count=POSES, pitch_limit=math.pi / 2):
    rng = np.random.default_rng(7)
    for _ in range(count):
        values = (*rng.uniform(-12, 12, 3), *rng.uniform(-math.pi, math.pi, 3))
        pose = dict(zip(search.AXES, values, strict=True))
        pose["pitch"] = rng.uniform(-pitch_limit, pitch_limit)
        yield search.pose_from_values(pose)


def edge_poses():
    for roll, pitch, yaw in ((0, 90, 0), (10, 90, 20), (-30, -90, 5), (180, 0, 180), (0, 0, -180)):
        yield pe.Pose.from_degrees((1.0, -0.5, 1.8), (roll, pitch, yaw))


def rig_of(name, pose):
    return pe.Rig([pe.Sensor(name, pe.catalog.load("Pandar64"), pose)])


def parents():
    """Yield a far and turned parent, a small one as CAD files bring along, and none."""
    yield None
    for scale, location in ((1.0, (3.0, -2.0, 0.5)), (0.001, (0.0, 0.0, 0.3))):
        parent = bpy.data.objects.new("parent", None)
        bpy.context.scene.collection.objects.link(parent)
        parent.location = location
        parent.scale = (scale,) * 3
        parent.rotation_euler = (0.3, -0.2, 1.0)
        yield parent


def test_what_is_placed_is_read_back(car):
    sensor = car.objects["roof"]
    for parent in parents():
        sensor.parent = parent
        for pose in (*random_poses(), *edge_poses()):
            assert document.place_rig(car, rig_of("roof", pose)) == []
            assert read(sensor) == pose


def test_what_is_typed_is_read(car):
    """Also without the memory of what was placed: the rounding alone has to do."""
    sensor = car.objects["roof"]
    for pose in random_poses(pitch_limit=math.radians(75)):
        sensor.location = pose.position
        sensor.rotation_euler = pose.rpy
        assert read(sensor) == pose


def test_moved_after_placing_is_read_as_it_stands(car):
    document.place_rig(car, rig_of("roof", pe.Pose((1.0, 2.0, 3.0))))
    car.objects["roof"].location.x = 1.00002
    assert read(car.objects["roof"]).position == (1.00002, 2.0, 3.0)


def test_sensor_on_a_sensor(car):
    """The outer one is moved first, or it would carry the inner one away."""
    inner = scenes.add_sensor("a_inner", model="Camera 60 deg", parent=car.objects["roof"])
    poses = [pe.Pose((1.0, 0.0, 2.0)), pe.Pose((-1.0, 0.5, 1.9), (0.0, 0.0, 1.0))]
    lidar = pe.catalog.load("Pandar64")
    rig = pe.Rig([pe.Sensor(n, lidar, p) for n, p in zip(("a_inner", "roof"), poses, strict=True)])
    document.place_rig(car, rig)
    assert read(inner).position == (1.0, 0.0, 2.0)
    assert read(car.objects["roof"]).position == (-1.0, 0.5, 1.9)


def test_quaternion_sensor(car):
    sensor = car.objects["roof"]
    sensor.rotation_mode = "QUATERNION"
    pose = pe.Pose.from_degrees((1.0, 0.0, 2.0), (1.5, 20.0, -35.0))
    document.place_rig(car, rig_of("roof", pose))
    assert read(sensor) == pose


def test_held_sensor_is_refused(car):
    sensor = car.objects["roof"]
    sensor.constraints.new("LIMIT_LOCATION").use_max_x = True
    with pytest.raises(pe.InputError, match="'roof': placement: expected an object that can be"):
        document.place_rig(car, rig_of("roof", pe.Pose((5.0, 0.0, 1.0))))


def test_axes_are_blenders(car):
    """Positive pitch is nose down, yaw is to the left: Rz Ry Rx, as Blender's XYZ Euler."""
    sensor = car.objects["roof"]
    sensor.rotation_euler = Euler((0.1, 0.2, 0.3), "XYZ")
    rotation = read(sensor).ground_from_sensor
    expected = np.array(Euler((0.1, 0.2, 0.3), "XYZ").to_matrix())
    assert np.abs(rotation - expected).max() < 1e-6


def sheared(car):
    shear = Matrix(((1.0, 0.5, 0.0, 0.0), (0.0, 0.8660254, 0.0, 0.0), (0, 0, 1, 0), (0, 0, 0, 1)))
    car.objects["roof"].parent = scenes.add_box(car.collection, "stretched")
    car.objects["roof"].matrix_parent_inverse = shear


def two_kinds(car):
    for name, model in (("a", "Pandar64"), ("b", "Camera 60 deg")):
        scenes.add_sensor(name, model=model).perception_entropy.fusion = "front"


def roof(**values):
    """A change of the sensor on the roof, or of its settings."""

    def change(car):
        for name, value in values.items():
            obj = car.objects["roof"]
            setattr(obj if hasattr(obj, name) else obj.perception_entropy, name, value)

    return change


REFUSED = {
    "sensor 'roof': scale: expected 1 .*found 2, 2, 2": roof(scale=(2.0, 2.0, 2.0)),
    "sensor 'roof': scale: expected 1 .*found 1, 1, 1.5": roof(scale=(1.0, 1.0, 1.5)),
    "sensor 'roof': scale: expected no mirroring": roof(scale=(-1.0, 1.0, 1.0)),
    "sensor 'roof': rotation: .*found shear": sheared,
    "sensor 'roof': placement: .*found NaN": roof(location=(math.nan, 0.0, 0.0)),
    "sensor 'roof': model: .*found 'Pandar65'": roof(model="Pandar65"),
    "sensors: expected at least one": lambda car: bpy.data.objects.remove(car.objects["roof"]),
    "vehicle collection: ": lambda car: setattr(car.perception_entropy, "vehicle", None),
    "fusion group 'front': expected one kind": two_kinds,
    "unit system: .*Imperial": lambda car: setattr(car.unit_settings, "system", "IMPERIAL"),
    "unit scale: .*0.001": lambda car: setattr(car.unit_settings, "scale_length", 0.001),
}


@pytest.mark.parametrize("line", REFUSED)
def test_a_scene_that_is_no_study_is_refused_in_one_line(car, line):
    REFUSED[line](car)
    with pytest.raises(pe.InputError, match=f"^scene: {line}"):
        scenes.study()
