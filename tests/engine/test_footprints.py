"""Footprints on the ground: as large as geometry says, and drawn where they are."""

import json
import math
from xml.etree import ElementTree

import numpy as np
import pytest

import pe_core as pe
from pe_tools.outputs import OutputRequest, scene_files
from pe_tools.outputs.ground_plan import ground_plan

from .shapes import box, box_car, camera, lidar_on_roof, small_lidar

RANGE = 20.0
SVG = "{http://www.w3.org/2000/svg}"
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


def area(outlines):
    """Area of closed outlines (N, 2); holes run the other way round."""
    edges = [(loop[:-1], loop[1:]) for loop in map(np.asarray, outlines)]
    return sum(float((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()) / 2.0 for a, b in edges)


def plan_of(*sensors, vehicle=None, range_m=RANGE):
    return ground_plan(OutputRequest(pe.Study(pe.Rig(sensors), vehicle), range_m))


def test_a_camera_that_looks_down_sees_its_picture_on_the_ground():
    down = camera(90.0, position=(1.0, 2.0, 3.0), rotation=(0.0, 90.0, 0.0))
    (one,) = plan_of(down)[0].footprints
    assert area(one.outlines) == pytest.approx(6.0 * 6.0 * 1080 / 1920, rel=1e-3)
    assert np.vstack(one.outlines).mean(axis=0) == pytest.approx([1.0, 2.0], abs=0.05)


def test_a_lidar_sees_a_ring_from_its_lowest_beam_to_its_range():
    (one,) = plan_of(lidar_on_roof(small_lidar()))[0].footprints
    inner = 1.8 / math.tan(math.radians(25.0))
    assert area(one.outlines) == pytest.approx(math.pi * (RANGE**2 - 1.8**2 - inner**2), rel=1e-3)
    assert sorted(area([loop]) > 0.0 for loop in one.outlines) == [False, True]


def test_a_wall_hides_the_ground_behind_it():
    wall = pe.Vehicle(box((5.0, -12.0, -3.0), (5.5, 12.0, 4.0)))
    eye = camera(90.0, position=(0.0, 0.0, 1.0))
    (one,) = plan_of(eye, vehicle=wall)[0].footprints
    assert np.vstack(one.outlines)[:, 0].max() == pytest.approx(5.0, abs=1e-3)


def test_footprints_are_polygons_of_the_ground():
    rig = lidar_on_roof(small_lidar()), camera(90.0, (1.0, 2.0, 3.0), (0.0, 90.0, 0.0), "down")
    files, _ = scene_files(pe.Study(pe.Rig(rig), box_car()), "footprints", RANGE)
    data = json.loads(files["footprints.geojson"])
    found = {each["properties"]["name"]: each for each in data["features"]}
    assert data["type"] == "FeatureCollection" and set(found) >= {"roof", "down", "vehicle"}
    for each in found.values():
        assert each["geometry"]["type"] == "MultiPolygon"
        for polygon in each["geometry"]["coordinates"]:
            areas = [area([ring]) for ring in polygon]
            assert areas[0] > 0.0 and all(value < 0.0 for value in areas[1:])
            assert all(ring[0] == ring[-1] for ring in polygon)
    body = found["vehicle"]["properties"]["area_m2"]
    assert body == pytest.approx(4.6 * 1.8, rel=0.01)


@pytest.fixture(scope="module")
def drawing(example_plugin):
    rig = lidar_on_roof(small_lidar(), name="roof <1>"), camera(name="front/eye")
    files, lines = scene_files(pe.Study(pe.Rig(rig), box_car()), "footprints-svg", RANGE)
    assert lines == []
    return ElementTree.fromstring(files["footprints.svg"])


def test_the_drawing_is_to_scale_and_has_a_layer_a_sensor(drawing):
    labels = [g.get(LABEL) for g in drawing.iter(f"{SVG}g")]
    known = ["Grid", "roof <1>", "front/eye", "Blind ground", "Vehicle", "Sensors", "Legend"]
    assert labels == [*known, "Scale"]
    _, _, width, height = map(float, drawing.get("viewBox").split())
    assert drawing.get("width") == f"{width * 10:.1f}mm"
    assert drawing.get("height") == f"{height * 10:.1f}mm"
    ids = [g.get("id") for g in drawing.iter(f"{SVG}g")]
    assert len(set(ids)) == len(ids) and not any(c in " <>/" for each in ids for c in each)
