"""Objects: what is refused, and the definition of m on boxes that a hand can work out."""

import pickle

import numpy as np
import pytest

import pe_core as pe
from tests.engine import shapes
from tests.engine.test_toy_kind import ring, ring_kind

__all__ = ["ring_kind"]


def objects(centers=((10.0, 0.0, 0.5),), size=(1.0, 1.0, 1.0), yaw=0.0, scenes=None):
    """Boxes of one size and heading."""
    count = len(centers)
    own = np.zeros(count, int)
    return pe.Objects(
        centers, [size] * count, [yaw] * count, own, class_names=("box",), scenes=scenes
    )


def test_objects_cannot_be_changed_and_are_sent_whole():
    some = objects([(10.0, 0.0, 0.5), (20.0, 0.0, 0.5)], scenes=[3, 3])
    again = pickle.loads(pickle.dumps(some))
    for name in ("centers", "sizes", "yaws", "labels", "scenes", "headings"):
        assert not getattr(some, name).flags.writeable
        assert getattr(again, name).tolist() == getattr(some, name).tolist()
    assert objects([(1.0, 0.0, 0.5)] * 2).scenes.tolist() == [0, 1]
    assert some.some([1]).centers.tolist() == [[20.0, 0.0, 0.5]]


def test_a_kind_that_measures_no_objects_says_so(ring_kind):
    with pytest.raises(pe.InputError, match=r"bumper: kind: expected .* objects, found 'toyring"):
        pe.measure_objects(ring(), objects())


def level_lidar(height=1.0, **options):
    """Channels at -10, 0 and 10 degrees, an azimuth a degree."""
    model = pe.Lidar("three", np.radians([-10.0, 0.0, 10.0]), 360, 60.0, **options)
    return pe.Sensor("s", model, pe.Pose((0.0, 0.0, height)))


def test_beams_on_a_box_by_hand():
    """A wall 2 m wide at 9.5 m: azimuths within atan(1 / 9.5) = 6.01 deg, so -6 to 6."""
    wall = objects([(10.0, 0.0, 1.0)], (1.0, 2.0, 2.0))
    assert pe.measure_objects(level_lidar(), wall).tolist() == [13.0]  # the horizontal channel
    high = objects([(10.0, 0.0, 2.0)], (1.0, 2.0, 4.0))
    # up 10 deg at 9.5 m is 1.675 m higher: 2.675 of 4 m, and the lowest 0.675 m under the sensor
    # is met at 9.5 m by -10 deg at z = -0.675: beside the box; channels 0 and 10 deg
    assert pe.measure_objects(level_lidar(), high).tolist() == [26.0]


def test_the_box_owns_the_beam_along_its_bottom_and_not_that_along_its_top():
    """The sensor is nudged upwards: the horizontal beam runs over a roof as high as it is."""
    at_top, at_bottom = (objects([(10.0, 0.0, z)], (1.0, 2.0, 1.0)) for z in (0.5, 1.5))
    assert pe.measure_objects(level_lidar(), at_top).tolist() == [0.0]
    assert pe.measure_objects(level_lidar(), at_bottom).tolist() == [13.0]


def test_an_object_hides_what_is_behind_it_in_its_scene_alone():
    """The nearer one is wider and as high, so nothing of the farther one is left."""
    both = [(10.0, 0.0, 1.0), (20.0, 0.0, 1.0)]
    together, apart = (objects(both, (1.0, 2.0, 2.0), scenes=s) for s in ([5, 5], [5, 6]))
    lidar = level_lidar()
    alone = pe.measure_objects(lidar, together)
    assert alone.tolist() == [13.0, 5.0]
    assert pe.measure_objects(lidar, together, traffic=True).tolist() == [13.0, 0.0]
    assert pe.measure_objects(lidar, apart, traffic=True).tolist() == alone.tolist()
    camera = shapes.camera(60.0, (0.0, 0.0, 1.0))
    near, far = pe.measure_objects(camera, together)
    assert pe.measure_objects(camera, together, traffic=True).tolist() == [near, 0.0]
    assert pe.measure_objects(camera, apart, traffic=True).tolist() == [near, far]


def test_an_object_that_holds_the_sensor_is_met_at_once_by_every_beam():
    inside = (0.0, 0.0, 1.0)
    behind = (20.0, 0.0, 1.0)
    both = objects([inside, behind], (2.0, 2.0, 2.0), scenes=[0, 0])
    assert pe.measure_objects(level_lidar(), both, traffic=True).tolist() == [1080.0, 0.0]
    near = level_lidar(min_range=0.5)
    assert pe.measure_objects(near, both, traffic=True).tolist() == [0.0, 0.0]
    assert pe.measure_objects(shapes.camera(60.0, (0.0, 0.0, 1.0)), both)[0] == 0.0


def test_ranges_are_of_where_a_beam_enters():
    """The wall's face is 9.5 m off straight ahead, and 9.552 m at 6 degrees."""
    wall = objects([(10.0, 0.0, 1.0)], (1.0, 2.0, 2.0))
    short = pe.Lidar("short", np.radians([0.0]), 360, 9.52)
    sensor = pe.Sensor("s", short, pe.Pose((0.0, 0.0, 1.0)))
    assert pe.measure_objects(sensor, wall).tolist() == [7.0]  # 9.5 / cos(3 deg) = 9.513
    assert pe.measure_objects(level_lidar(min_range=9.52), wall).tolist() == [6.0]


def test_pixels_of_a_box_by_hand():
    """A face of 1 m by 1 m, 9.5 m ahead: a square of 1 / 9.5 focal lengths."""
    camera = shapes.camera(60.0, (0.0, 0.0, 0.5))
    side = camera.model.focal_px / 9.5
    assert pe.measure_objects(camera, objects()).tolist() == pytest.approx([side**2])
