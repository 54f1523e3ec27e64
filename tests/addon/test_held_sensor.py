"""The sensor that is held under the mouse: its stand-off, its words, and that it lets go."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from mathutils import Vector

from blender_addon.engine import catalog
from blender_addon.operators import place_sensor, placement, surface_pose
from blender_addon.operators.surface_pose import SurfaceSpot
from blender_addon.view import viewport
from tests.addon import layouts, scenes

ROOF = SurfaceSpot(Vector((-0.3, 0.0, 1.5)), Vector((0.0, 0.0, 1.0)), "cabin")


@pytest.fixture
def held(car, monkeypatch):
    """Return a camera that is held, as it is when the button was pressed."""
    monkeypatch.setattr(viewport, "VIEW", layouts.View3D)
    told = []
    workspace = SimpleNamespace(name="none", status_text_set=told.append)
    context = SimpleNamespace(
        scene=car, workspace=workspace, evaluated_depsgraph_get=scenes.depsgraph
    )
    placement.begin(context, catalog.load("Camera 60 deg"), surface_pose.Stance(0.05))
    yield placement.current
    placement.end()
    assert not layouts.View3D.handles


def test_what_is_held_changes_nothing_in_the_scene(held, car):
    before = [obj.name for obj in car.objects]
    held.put(ROOF)
    assert held.matrix.translation.z == pytest.approx(1.55)
    assert [obj.name for obj in car.objects] == before


def test_arrow_keys_turn_it_from_the_direction_of_its_place(held):
    held.put(ROOF)
    assert held.angles == (180.0, 0.0), "behind the middle it looks back"
    for key in ("LEFT_ARROW", "DOWN_ARROW"):
        held.stand(held.stance.turned(*(5.0 * way for way in place_sensor.TURNS[key])))
    assert held.angles == (-175.0, 5.0)
    ahead = held.matrix.col[0].to_3d()
    assert ahead.z == pytest.approx(-math.sin(math.radians(5.0)), abs=1e-6), "down is nose down"
    assert held.text[1].endswith("upright, yaw -175°, pitch 5°")
    held.put(None)
    held.put(ROOF)
    assert held.angles == (-175.0, 5.0), "it goes on as it was turned"
    for _ in range(40):
        held.stand(held.stance.turned(10.0, 5.0))
    assert held.stance.pitch_deg == 90.0 and -180.0 <= held.stance.yaw_deg < 180.0


def test_it_is_drawn_where_it_stands_and_as_it_is_turned(held):
    held.put(ROOF)
    points = held.lines.points
    place = np.array(held.matrix.translation)
    assert np.abs(points - place).max() < placement.LENGTH_M + 0.2
    pinhole = np.abs(points - place).sum(axis=1) < 1e-5
    assert pinhole.sum() >= 4  # the frustum's edges begin there
    held.stand(surface_pose.Stance(0.05, along_normal=True))
    assert held.lines.points[:, 2].max() > place[2] + 1.5  # it looks up now
