"""Labels of sensors that are named after their kind alone: where they are mounted."""

import numpy as np
import pytest

import pe_core as pe
from pe_tools.advice import place_name, plain_name, sensor_labels
from tests.engine import shapes

CAR = np.array([-2.4, -1.0, 0.0]), np.array([2.4, 1.0, 1.45])
LEFT_MIRROR = np.array([0.8, 0.9, 0.9]), np.array([1.0, 1.1, 1.1])


@pytest.mark.parametrize(
    ("position", "place"),
    [
        ((2.35, 0.0, 0.6), "front"),
        ((2.2, 0.8, 0.6), "front left"),
        ((-2.3, 0.1, 0.9), "rear"),
        ((-2.3, -0.9, 0.6), "rear right"),
        ((0.0, 0.0, 1.8), "roof"),
        ((0.0, 0.6, 1.5), "roof left"),
        ((0.9, 1.15, 1.0), "left mirror"),
        ((0.9, -1.05, 1.0), "right side"),
        ((0.4, 0.0, 1.2), "cabin"),
    ],
)
def test_a_place_in_words(position, place):
    assert place_name(position, CAR, (LEFT_MIRROR,)) == place


@pytest.mark.parametrize(
    ("name", "plain"),
    [
        ("Camera", "Camera"),
        ("LiDAR.001", "LiDAR"),
        ("Camera.0011", "Camera"),
        ("Camera left", None),
        ("roof_lidar", None),
        ("Camera.1", None),
    ],
)
def test_names_that_say_the_kind_alone(name, plain):
    assert plain_name(name) == plain


def test_labels_are_places_and_never_the_same_twice():
    camera, lidar = pe.catalog.load("Camera 90 deg"), shapes.small_lidar(4, 90)
    car = shapes.box_car()
    front, rear = car.bounds[1][0], car.bounds[0][0]
    given = [
        ("Camera", camera, (front, 0, 0.5)),
        ("LiDAR", lidar, (front, 0, 0.4)),
        ("Camera.001", camera, (front, 0.05, 0.6)),
        ("Camera.002", camera, (rear, 0, 0.5)),
        ("my eye", camera, (front, 0, 0.3)),
    ]
    rig = [pe.Sensor(name, model, pe.Pose(place)) for name, model, place in given]
    assert sensor_labels(rig, car) == {
        "Camera": "front Camera 1",
        "LiDAR": "front LiDAR",
        "Camera.001": "front Camera 2",
        "Camera.002": "rear",
        "my eye": "my eye",
    }
    assert sensor_labels(rig, None)["Camera.001"] == "Camera.001", "nothing to be placed on"
