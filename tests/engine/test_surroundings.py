"""What a camera's picture shows around the vehicle: where lanes are, and where bodies stand."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core.scoring.requirements import BODIES
from pe_tools.graphics import surroundings
from pe_tools.graphics.surroundings import FAR_M, PAINT, STANDING
from tests.engine import shapes


def eye(position, rotation=(0, 0, 0)):
    return pe.Pose.from_degrees(position, rotation)


@pytest.mark.parametrize("rotation", [(0, 0, 0), (0, 35, 140), (10, -5, -90), (0, 90, 30)])
def test_bodies_of_the_requirements_stand_at_5_10_and_20_metres(rotation):
    """On the ground, as large as they are, ahead of where the sensor looks."""
    found = surroundings(eye((1.0, -2.0, 1.4), rotation)).bodies
    assert sorted(distance for _, distance, *_ in STANDING) == [5.0, 10.0, 20.0]
    heading = math.radians(rotation[2])
    corners = found.thin.points.reshape(len(STANDING), -1, 3)
    for (name, distance, bearing, _), points, tag in zip(
        STANDING, corners, found.labels, strict=True
    ):
        low, high = points.min(axis=0), points.max(axis=0)
        body = BODIES[name]
        assert (low[2], high[2]) == pytest.approx((body.low, body.low + body.size[2]))
        away = np.array(tag.place[:2]) - (1.0, -2.0)
        assert math.hypot(*away) == pytest.approx(distance)
        turned = math.atan2(away[1], away[0]) - heading - math.radians(bearing)
        assert math.remainder(turned, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-6)
        diagonal = np.hypot(*(high - low)[:2])
        assert diagonal <= math.sqrt(2.0) * math.hypot(*body.size[:2]) + 1e-6
        assert f"{distance:g} m" in tag.text


def test_none_stands_in_the_vehicle():
    low, high = np.array([-9.0, -1.4, 0.0]), np.array([6.0, 1.4, 3.0])
    found = surroundings(eye((0.5, 0.0, 3.1)), (low, high)).bodies
    assert [tag.text for tag in found.labels] == ["car, 20 m", "cyclist, 10 m"]
    assert len(surroundings(eye((0.5, 0.0, 3.1)), shapes.box_car().bounds).bodies.labels) == 3


def test_lanes_are_three_and_a_half_metres_wide_and_the_ground_ends_at_the_horizon():
    ground = surroundings(eye((40.0, 3.0, 1.5))).ground
    white = (ground.faces.colors == np.float32(PAINT)).all(axis=1)

    middles = np.unique(
        (ground.faces.points[white].reshape(-1, 6, 3)[..., 1]).mean(axis=1).round(3)
    )
    assert middles.tolist() == [-5.25, -1.75, 1.75, 5.25], "the vehicle is in the middle lane"
    away = np.hypot(*(ground.faces.points[~white][:, :2] - (40.0, 3.0)).T)
    assert away.max() == pytest.approx(FAR_M)
    lines = ground.thin.points.reshape(-1, 2, 3)
    whole = np.isclose(lines, np.rint(lines), atol=1e-4)
    assert whole[:, :, :2].all(axis=1).any(axis=1).all(), "a line at each metre"
    assert ground.thin.colors[:, 3].max() > 0.5 and ground.thin.colors[:, 3].min() == 0.0
