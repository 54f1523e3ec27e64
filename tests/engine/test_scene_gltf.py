"""The scene as glTF: nodes stand where sensors are, whatever is up."""

import json
import math

import numpy as np
import pytest

import pe_core as pe
from pe_tools.outputs import scene_files

from .shapes import box_car, tilted_rig

OURS_FROM_GLTF = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
RIG = tilted_rig()


def document_of(data):
    """The JSON of a .glb, and its binary chunk."""
    size = int.from_bytes(data[12:16], "little")
    assert data[:4] == b"glTF" and int.from_bytes(data[8:12], "little") == len(data)
    return json.loads(data[20 : 20 + size]), data[28 + size :]


def turned(quaternion):
    """(3, 3) rotation of a quaternion (x, y, z, w)."""
    x, y, z, w = quaternion
    a = np.array([x, y, z])
    b = np.eye(3)
    c = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return (w * w - a @ a) * b + 2.0 * np.outer(a, a) + 2.0 * w * c


def in_world(document):
    """Rotation and place of every node in the axes of glTF, by name."""
    found = {}

    def walk(number, rotation, place):
        node = document["nodes"][number]
        place = place + rotation @ np.array(node.get("translation", (0.0, 0.0, 0.0)))
        rotation = rotation @ turned(node.get("rotation", (0.0, 0.0, 0.0, 1.0)))
        found[node["name"]] = rotation, place
        for child in node.get("children", ()):
            walk(child, rotation, place)

    walk(document["scenes"][0]["nodes"][0], np.eye(3), np.zeros(3))
    return found


@pytest.fixture(scope="module")
def scene():
    study = pe.Study(RIG, box_car(), reference=pe.Reference(-1.3, 0.32))
    files, lines = scene_files(study, "gltf")
    assert lines == []
    return document_of(files["scene.glb"])


@pytest.mark.parametrize("sensor", RIG.sensors, ids=lambda s: s.name)
def test_a_sensor_s_node_stands_and_looks_as_the_sensor(scene, sensor):
    rotation, place = in_world(scene[0])[sensor.name]
    to_ours = OURS_FROM_GLTF
    assert to_ours @ place == pytest.approx(sensor.pose.position, abs=1e-9)
    ours = to_ours @ rotation @ to_ours.T
    assert ours == pytest.approx(sensor.pose.ground_from_sensor, abs=1e-9)


def test_a_camera_looks_along_its_own_minus_z_with_y_up(scene):
    rotation, _ = in_world(scene[0])["eye view"]
    forward, left, up = RIG["eye"].pose.ground_from_sensor.T
    assert OURS_FROM_GLTF @ -rotation[:, 2] == pytest.approx(forward, abs=1e-9)
    assert OURS_FROM_GLTF @ rotation[:, 1] == pytest.approx(up, abs=1e-9)
    assert OURS_FROM_GLTF @ rotation[:, 0] == pytest.approx(-left, abs=1e-9)
    seen = scene[0]["cameras"][0]["perspective"]
    wide = 2.0 * math.atan(math.tan(seen["yfov"] / 2.0) * seen["aspectRatio"])
    assert wide == pytest.approx(math.radians(70.0))


def test_the_vehicle_s_triangles_and_rear_axle_are_there(scene):
    document, data = scene
    body = next(m for m in document["meshes"] if m["name"] == "body")["primitives"][0]
    assert document["materials"][body["material"]]["name"] == "body"
    _, axle = in_world(document)["Grp_Rear_Axle_Center"]
    assert OURS_FROM_GLTF @ axle == pytest.approx((-1.3, 0.0, 0.32))
    corners = []
    for key, kind, width in (
        (body["attributes"]["POSITION"], "<f4", 3),
        (body["indices"], "<u4", 1),
    ):
        accessor = document["accessors"][key]
        view = document["bufferViews"][accessor["bufferView"]]
        part = data[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
        corners.append(np.frombuffer(part, kind).reshape(accessor["count"], width))
    triangles = corners[0][corners[1].ravel()].reshape(-1, 3, 3) @ OURS_FROM_GLTF.T
    car = box_car()
    assert triangles == pytest.approx(car.triangles[car.parts == 0], abs=1e-6)
