"""What is written, read by the programs that it is for, or by the library they read it with."""

import io
import json
import math

import numpy as np
import pytest

import pe_core as pe
from pe_tools.exchange import rig_files
from pe_tools.outputs import scene_files

from .shapes import box_car, tilted_rig

AXLE = pe.Reference(-1.3, 0.32)
RIG = tilted_rig()
EYE = RIG["eye"]
STUDY = pe.Study(RIG, box_car(), reference=AXLE)
SEEN = np.array([10.0, 2.0, -1.0])
"""A point in front of the camera: forward, left, up [m]."""
GROUND = EYE.pose.ground_from_sensor @ SEEN + EYE.pose.position
F = EYE.model.focal_px
PIXEL = (960.0 - 0.2 * F, 540.0 + 0.1 * F)
"""Where it falls: 0.2 to the left of the axis, 0.1 below it."""
FIELDS = {
    "sensor.json": {"token": str, "channel": str, "modality": str},
    "calibrated_sensor.json": {
        "token": str,
        "sensor_token": str,
        "translation": list,
        "rotation": list,
        "camera_intrinsic": list,
    },
}
"""nutonomy/nuscenes-devkit d9de17a, docs/schema_nuscenes.md."""


def rpy_matrix(roll, pitch, yaw):
    """URDF's fixed axes: about x, then y, then z."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def root_from(robot, link):
    """(4, 4) of a link in its robot's root, along urdf_parser_py's own chain of joints."""
    found = np.eye(4)
    for name in robot.get_chain(robot.get_root(), link, links=False):
        joint = robot.joint_map[name]
        step = np.eye(4)
        assert joint.type == "fixed"
        step[:3, :3] = rpy_matrix(*joint.origin.rpy)
        step[:3, 3] = joint.origin.xyz
        found = found @ step
    return found


def test_ros_own_parser_reads_the_urdf(capsys):
    """The optical frame of a camera: z to the point, x right, y down (REP 103)."""
    urdf = pytest.importorskip("urdf_parser_py.urdf", reason="of the extra test")
    files, _ = rig_files(RIG, "urdf")
    robot = urdf.URDF.from_xml_string(files["rig.urdf"])
    assert capsys.readouterr().err == "", "it complains there of what it does not know"
    root = root_from(robot, "base_link")
    optical = root_from(robot, "eye_optical")
    right, down, depth = np.linalg.inv(optical)[:3] @ root @ [*GROUND, 1.0]
    assert (F * right / depth + 960.0, F * down / depth + 540.0) == pytest.approx(PIXEL)
    roof = np.linalg.inv(root) @ root_from(robot, "roof")
    assert roof[:3, 3] == pytest.approx(RIG["roof"].pose.position)
    assert roof[:3, :3] == pytest.approx(RIG["roof"].pose.ground_from_sensor)


def test_nuscenes_tables_are_of_its_schema_and_project_as_its_devkit_does():
    """``Quaternion(rotation).inverse`` of what is from the translation, then the intrinsics."""
    quaternion = pytest.importorskip("pyquaternion", reason="of the extra test").Quaternion
    files, _ = rig_files(RIG, "nuscenes", AXLE)
    tables = {name: json.loads(data) for name, data in files.items()}
    for name, fields in FIELDS.items():
        for row in tables[name]:
            assert {key: type(row[key]) for key in fields} == fields
            assert len(row["token"]) == 32 and int(row["token"], 16)
    sensors = {row["token"]: row for row in tables["sensor.json"]}
    assert {row["modality"] for row in sensors.values()} == {"camera", "lidar"}
    rows = {sensors[r["sensor_token"]]["channel"]: r for r in tables["calibrated_sensor.json"]}
    assert len(rows["eye"]["camera_intrinsic"]) == 3 and rows["roof"]["camera_intrinsic"] == []
    ego = GROUND - [AXLE.rear_axle_x, 0.0, 0.0]
    turn = quaternion(rows["eye"]["rotation"])
    assert turn.norm == pytest.approx(1.0, abs=1e-12)
    seen = turn.inverse.rotation_matrix @ (ego - rows["eye"]["translation"])
    u, v, w = np.array(rows["eye"]["camera_intrinsic"]) @ seen
    assert (u / w, v / w) == pytest.approx(PIXEL)


@pytest.mark.parametrize("name", ["ros", "autoware"])
def test_yaml_s_own_parser_reads_a_camera_s_intrinsics(name):
    yaml = pytest.importorskip("yaml", reason="of the extra test")
    files, _ = rig_files(RIG, name, AXLE)
    info = yaml.safe_load(files["camera_info/eye.yaml"])
    assert (info["image_width"], info["image_height"]) == (1920, 1080)
    matrix = np.array(info["camera_matrix"]["data"]).reshape(3, 3)
    u, v, w = matrix @ [-SEEN[1], -SEEN[2], SEEN[0]]
    assert (u / w, v / w) == pytest.approx(PIXEL)
    assert len(info["projection_matrix"]["data"]) == 12


def test_trimesh_has_the_scene_s_nodes_where_the_sensors_are():
    """In glTF's axes: ours (x, y, z) is its (x, z, -y)."""
    trimesh = pytest.importorskip("trimesh", reason="of the extra test")
    files, _ = scene_files(STUDY, "gltf")
    scene = trimesh.load(io.BytesIO(files["scene.glb"]), file_type="glb")
    world_from_node, _ = scene.graph.get("eye")
    x, y, z, _ = world_from_node @ [SEEN[0], SEEN[2], -SEEN[1], 1.0]
    assert (x, -z, y) == pytest.approx(tuple(GROUND))
    low, high = scene.geometry["body"].bounds
    assert (low[0], high[0]) == pytest.approx((-2.3, 2.3), abs=1e-6)


def test_kitti_s_lines_project_as_its_readers_do():
    """pykitti and the devkit: ``key: numbers`` a line; y = P R0_rect Tr_velo_to_cam x."""
    lines = rig_files(RIG, "kitti")[0]["calib.txt"].decode().splitlines()
    rows = {key: np.array(values.split(), dtype=float) for key, values in
            (line.split(":", 1) for line in lines if line)}  # fmt: skip
    rectified = np.eye(4)
    to_camera = np.eye(4)
    rectified[:3, :3] = rows["R0_rect"].reshape(3, 3)
    to_camera[:3] = rows["Tr_velo_to_cam"].reshape(3, 4)
    roof = RIG["roof"].pose
    velodyne = roof.ground_from_sensor.T @ (GROUND - roof.position)
    u, v, w = rows["P0"].reshape(3, 4) @ rectified @ to_camera @ [*velodyne, 1.0]
    assert (u / w, v / w) == pytest.approx(PIXEL)


def test_trimesh_finds_every_solid_closed_and_outwards(example_plugin):
    trimesh = pytest.importorskip("trimesh", reason="of the extra test")
    files, _ = scene_files(STUDY, "solids", 10.0)
    solids = {name: data for name, data in files.items() if name.endswith(".stl")}
    assert {"eye_free.stl", "roof_field.stl", "blind_volume.stl"} <= set(solids)
    for name, data in solids.items():
        solid = trimesh.load(io.BytesIO(data), file_type="stl")
        assert solid.is_watertight and solid.is_winding_consistent, name
        assert solid.volume > 0.0, name
