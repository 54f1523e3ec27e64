"""Drafts: beams stopped by a map of the vehicle's top, close to the cast and never in its place."""

import numpy as np
import pytest

import pe_core as pe
from pe_core.sensors.lidar.beams import RotatedBeams
from pe_core.sensors.lidar.occlusion import ApproximateOcclusion, BeamSlopes, TopMap
from tests.engine import shapes

SPACE = shapes.small_space(0.25)
CAR = shapes.box_car(2)


def evaluator():
    return pe.Evaluator(SPACE, pe.Prior.road(), CAR, samples=20_000)


def rig_at(*places):
    sensors = [
        shapes.lidar_on_roof(position=place, name=f"lidar {n}") for n, place in enumerate(places)
    ]
    return pe.Rig(sensors)


@pytest.mark.parametrize("rotation", [(0, 0, 0), (3, -8, 40)])
@pytest.mark.parametrize("place", [(-0.43, 0.0, 1.8), (0.3, 0.2, 1.6), (1.9, 0.0, 1.4), (5, 0, 2)])
def test_a_preview_stops_nearly_the_same_beams(place, rotation):
    sensor = shapes.lidar_on_roof(position=place, rotation=rotation)
    cast = pe.beam_field(sensor, CAR).ends
    preview = ApproximateOcclusion(CAR).ends(sensor, RotatedBeams(sensor).slopes)
    stopped = cast < 200.0
    assert np.mean(stopped != (preview < 200.0)) < 0.01
    both = stopped & (preview < 200.0)
    assert both.sum() > 100 or place[0] == 5
    assert not both.any() or np.median(np.abs(preview - cast)[both] / cast[both]) < 0.05


@pytest.mark.parametrize("place", [(-0.43, 0.0, 1.8), (0.3, 0.2, 1.6), (1.9, 0.0, 1.4)])
def test_a_preview_s_entropy_is_close(place):
    own = evaluator()
    preview = own.entropy(rig_at(place), preview=True)
    assert preview == pytest.approx(own.entropy(rig_at(place)), abs=0.06)


def test_a_score_says_that_it_is_a_preview_and_the_next_is_not():
    own, rig = evaluator(), rig_at((0.3, 0.2, 1.6))
    preview, exact = own.score(rig, preview=True), own.score(rig)
    assert preview.preview and preview.to_dict()["preview"] is True
    assert not exact.preview and "preview" not in exact.to_dict()
    assert exact.to_dict() == evaluator().score(rig).to_dict()
    assert preview.entropy != exact.entropy


def test_sensors_that_stayed_are_not_previewed():
    own = evaluator()
    both, one = rig_at((0.3, 0.2, 1.6), (-1.0, 0.0, 1.7)), rig_at((0.3, 0.2, 1.6))
    own.entropy(one)
    first = own.score(both, preview=True)
    assert first.preview
    assert not own.score(both).preview
    assert not own.score(both, preview=True).preview  # nothing has moved: it is known exactly


def test_a_sensor_below_the_top_is_cast():
    own, rig = evaluator(), rig_at((2.31, 0.0, 0.6), (0.0, 0.0, 1.0))
    score = own.score(rig, preview=True)
    assert not score.preview
    assert score.to_dict() == evaluator().score(rig).to_dict()


def test_a_roof_hides_what_is_below_its_edge():
    """A 2 x 2 m plate seen from 0.5 m above its middle: its edge is 26.6 degrees down ahead."""
    plate = shapes.box((-1, -1, 1.0), (1, 1, 1.1))
    angles = np.radians(np.arange(-60.0, 30.0, 0.5))
    beams = np.stack([np.cos(angles), 0 * angles, np.sin(angles)], axis=1)
    ends = TopMap(plate).ends(np.array([0.0, 0.0, 1.6]), BeamSlopes.of(beams), 100.0)
    edge = np.degrees(np.arctan2(-0.5, 1.0))
    clear = np.degrees(angles) > edge
    assert np.count_nonzero((ends == 100.0) != clear) <= 3
    low = np.degrees(angles) < edge - 3
    assert ends[low] * -np.sin(angles[low]) == pytest.approx(0.5, rel=0.05)
