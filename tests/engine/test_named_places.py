"""Named places of a body, by hand and on the example vehicles; templates that fill them."""

import math

import numpy as np
import pytest

import pe_core as pe
from pe_core import catalog
from pe_core.scene import PLACE_NAMES, named_places
from pe_tools import read_mesh
from pe_tools.cli.verbs import main
from tests.engine.test_docs import ROOT


def vehicle(name="sedan"):
    mesh = read_mesh(ROOT / "blend_assets" / f"{name}.npz")
    return pe.Vehicle(mesh.triangles, mesh.parts, mesh.part_names)


def box(low, high):
    """Return the twelve triangles of a box."""
    x, y, z = ((a, b) for a, b in zip(low, high, strict=True))
    corner = np.array([(i, j, k) for i in x for j in y for k in z])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [corner[[a, b, c]] for p, q, r, s in sides for a, b, c in ((p, q, r), (p, r, s))]
    return np.array(faces)


def test_places_of_a_block_with_mirrors_by_hand():
    """4 x 2 x 2 m; mirrors of 0.2 m at x 0.8 to 1.0, z 1.2 to 1.4."""
    body = box((-2, -1, 0), (2, 1, 2))
    mirrors = [box((0.8, s - 0.1, 1.2), (1.0, s + 0.1, 1.4)) for s in (1.1, -1.1)]
    parts = np.repeat([0, 1, 2], 12)
    found = named_places(
        pe.Vehicle(np.concatenate([body, *mirrors]), parts, ("body", "mirror_l", "mirror_r"))
    )
    assert tuple(found) == PLACE_NAMES
    assert found["roof"].point == (0, 0, 2) and found["roof"].outward == (0, 0, 1)
    assert found["grille"].point == (2, 0, 0.8) and found["grille"].outward == (1, 0, 0)
    assert found["bumper rear left"].point == pytest.approx((-2, 1, 0.6), abs=1e-3)
    assert found["bumper rear left"].yaw_deg == 135.0
    assert found["mirror right"].point == (1, -1.2, 1.3)
    assert found["mirror right"].outward == (0, -1, 0)
    assert found["tailgate"].beside(0.05) == (-2.05, 0, 1.24)


@pytest.mark.parametrize("name", ["sedan", "bus"])
def test_they_lie_on_the_body_and_left_is_where_right_is(name):
    body = vehicle(name)
    found = named_places(body)
    for key, place in found.items():
        start = np.array(place.point) + 0.5 * np.array(place.outward)
        hit = body.first_hit_from(start, -np.array([place.outward]))
        assert hit.distance[0] == pytest.approx(0.5, abs=0.03), key
        if "left" in key and not ("mirror" in key and name == "bus"):  # its door is on one side
            x, y, z = found[key.replace("left", "right")].point
            assert place.point == pytest.approx((x, -y, z), abs=0.02), key


@pytest.mark.parametrize("key", catalog.templates())
def test_a_template_is_a_study_named_and_coloured_by_place(key, tmp_path, capsys):
    mesh = str(ROOT / "blend_assets" / "sedan.npz")
    assert main(["new", mesh, "--rig", key, "-o", str(tmp_path / "study.toml")]) == 0
    rig = pe.load_study(tmp_path / "study.toml").rig
    places = named_places(vehicle())
    template = catalog.templates()[key]
    assert len(rig) == len(template.sensors)
    for sensor, (place, model, _yaw, pitch) in zip(rig, template.sensors, strict=True):
        assert sensor.name.endswith(f" {place}") and sensor.model is catalog.load(model)
        off = math.dist(sensor.pose.position, places[place].point)
        assert 0.02 < off < 0.16 and sensor.pose.rotation_deg[1] == pytest.approx(pitch)
    assert len({sensor.color for sensor in rig}) >= len(rig) - 1
    shown = main(["new", "--rig", key]), capsys.readouterr().out
    assert shown[0] == 0 and template.title in shown[1]
    assert main(["new", "--rig", key, "-o", str(tmp_path / "other.toml")]) != 0, "no vehicle"


def test_a_known_rig_goes_to_the_nearest_places_one_each(tmp_path):
    mesh = str(ROOT / "blend_assets" / "sedan.npz")
    output = str(tmp_path / "study.toml")
    line = ["new", mesh, "--rig", "nuscenes", "--placement", "places", "-o", output]
    assert main(line) == 0
    rig = pe.load_study(output).rig
    places = named_places(vehicle())
    assert rig["LIDAR_TOP"].pose.position == places["roof"].beside(0.15)
    assert rig["CAM_BACK"].pose.rotation_deg[2] == pytest.approx(179.857)
    assert len({sensor.pose.position for sensor in rig}) == len(rig)
