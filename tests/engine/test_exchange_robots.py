"""Robots in URDF and SDF: poses of sensors on their links, which links are sensors, scans."""

import math
from xml.etree import ElementTree

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.exchange import rig_files
from tests.thorough import pairs

JOINT = (
    '<joint name="{1}_j" type="{3}"><parent link="{0}"/><child link="{1}"/>'
    '<origin xyz="{2}"/></joint>'
)
SCAN = (
    "<lidar><scan><horizontal><samples>{0}</samples><min_angle>{1}</min_angle>"
    "<max_angle>{2}</max_angle></horizontal><vertical><samples>{3}</samples>"
    "<min_angle>-0.2</min_angle><max_angle>0.1</max_angle></vertical></scan>"
    "<range><min>0.5</min><max>100</max></range></lidar>"
)
CAMERA = (
    "<camera{1}><horizontal_fov>{0}</horizontal_fov><image><width>640</width><height>480</height>"
    "</image></camera>"
)
MAST = ("base_link", "mast", "0 0 1", "fixed")
AT_FRONT = "<pose>0.5 0 0.25 0 0.3 0</pose>"
FULL_SCAN = SCAN.format(360, -math.pi, math.pi, 16)
FRONT = f'<sensor name="front" type="gpu_lidar">{AT_FRONT}{FULL_SCAN}</sensor>'
QUATERNION = '<pose rotation_format="quat_xyzw">0 0 0 0 0 0.6 0.8</pose>'
TURNED = f'<sensor name="t" type="depth_camera">{QUATERNION}{CAMERA.format(1.0, "")}</sensor>'
TRUTH = '<sensor name="boxes" type="boundingbox_camera"><pose>1 0 0 0 0 0</pose></sensor>'
LINKS = [
    ("base_link", "lidar_mount", "0 0 1.7", "fixed"),
    ("lidar_mount", "lidar_base", "0 0 0.05", "fixed"),
    ("lidar_base", "lidar_top", "0 0 0.05", "fixed"),
    ("base_link", "camera_front", "1 0 1.2", "fixed"),
    ("camera_front", "camera_front_optical_frame", "0 0 0", "fixed"),
    ("base_link", "wheel_left", "1.4 0.8 0.3", "continuous"),
    ("base_link", "antenna_marker", "-1 0 1.5", "fixed"),
    ("base_link", "imu_link", "0 0 0.5", "fixed"),
    ("base_link", "top_plate", "0 0 1.6", "fixed"),
    ("base_link", "steer", "1 0 0.5", "revolute"),
    ("base_link", "shelf", "0 0 1.5", "fixed"),
]
XACRO = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="r">{}</robot>'
FANS = [
    (5, -60, 60, [-60, -30, 0, 30, 60]),
    (4, -60, 60, [-60, -20, 20, 60]),  # half a step beside those of a full circle
    (4, -50, 25, [-50, -25, 0, 25]),  # 360 is no multiple of 25
    (3, 10, 12, [10, 11, 12]),
    (9, -180, 180, [-135, -90, -45, 0, 45, 90, 135, 180]),  # both ends are one direction
    (8, -180, 135, [-180, -135, -90, -45, 0, 45, 90, 135]),
    (4, 0, 270, [-90, 0, 90, 180]),
    (720, -90, 90, np.linspace(-90, 90, 720)),
    (1081, -135, 135, np.linspace(-135, 135, 1081)),
]
SCANS = [(-60.0, 60.0, 0.1), (-45.0, 44.0, 1.0), (-180.0, 180.0, 0.2), (-180.0, 180.0, 40.0)]
SDF = f"""<sdf version="1.9"><world name="w"><model name="car"><pose>5 5 0 0 0 1</pose>
<include><uri>model://wheel</uri></include>
<link name="body"><pose>0 0 0.5 0 0 0</pose>
  <sensor name="low" type="gpu_lidar"><pose>2 0 0 0 0 0</pose>{SCAN.format(90, -1, 1, 4)}</sensor>
  <sensor name="imu" type="imu"/></link>
<link name="nose"><sensor name="s" type="sonar"><range>9</range></sensor></link>
<frame name="roof" attached_to="body"><pose>0 0 1.2 0 0 0</pose></frame>
<link name="eye"><pose relative_to="roof">0.3 0 0.1 0 0 1.5707963267948966</pose>
  <sensor name="e" type="camera">{CAMERA.format(1.0, "")}</sensor></link>
<model name="rack"><pose>0 1 0 0 0 0</pose><link name="bar"><pose>0 0 2 0 0 0</pose>
  <sensor name="top" type="lidar"><pose relative_to="bar">0 0 0.2 0 0 0</pose>
  {SCAN.format(90, -1, 1, 4)}</sensor></link></model>
</model><model name="house"/></world></sdf>"""


def robot(joints, *blocks, masses=(), root="base_link"):
    """A robot of (parent, link, place, type of joint); links with a mass."""
    links = [root, *(row[1] for row in joints)]
    inertial = '<inertial><mass value="0.8"/></inertial>'
    text = "".join(f'<link name="{n}">{inertial if n in masses else ""}</link>' for n in links)
    text += "".join(JOINT.format(*row) for row in joints)
    return f'<robot name="r">{text}{"".join(blocks)}</robot>'


def read(folder, text, name="r.urdf"):
    (folder / name).write_text(text)
    return pt.import_rig(folder / name)


EYE = '<sensor name="eye" type="camera"><pose degrees="true">0.6 0 0.1 0 0 90</pose>{}</sensor>'
EYE = EYE.format(CAMERA.format(1.0, ""))


def test_sensors_are_on_their_link_by_their_own_pose(tmp_path):
    """The mast is 1 m up; two blocks of one link; ground truth is no sensor."""
    text = robot(
        [MAST],
        f'<gazebo reference="mast">{FRONT}{EYE}{TRUTH}</gazebo>',
        f'<gazebo reference="mast">{TURNED}</gazebo>',
    )
    found = read(tmp_path, text)
    poses = {s.name: (s.kind, s.pose) for s in found.rig}
    assert {name: kind for name, (kind, _) in poses.items()} == {
        "front": "lidar",
        "eye": "camera",
        "t": "camera",
    }
    assert poses["front"][1].position == (0.5, 0.0, 1.25)
    assert poses["front"][1].rpy == pytest.approx((0.0, 0.3, 0.0))
    assert poses["eye"][1].position == pytest.approx((0.6, 0.0, 1.1))
    assert poses["eye"][1].rotation_deg == pytest.approx((0.0, 0.0, 90.0))
    assert poses["t"][1].rpy == pytest.approx((0.0, 0.0, 2.0 * math.atan2(0.6, 0.8)))
    assert found.lines[0].startswith("left out: 1 boundingbox_camera sensor (boxes)")


def test_a_sensor_of_two_cameras_is_two(tmp_path):
    cameras = "".join(
        CAMERA.format(fov, f' name="{name}"').replace(
            "<image>", f"<pose>0 {y} 0 0 0 0</pose><image>"
        )
        for name, fov, y in (("left", 1.0, 0.1), ("right", 1.2, -0.1))
    )
    block = f'<gazebo reference="mast"><sensor name="s" type="multicamera">{cameras}</sensor>'
    found = read(tmp_path, robot([MAST], block + "</gazebo>"))
    rows = [(s.name, s.pose.position, round(s.model.hfov, 9)) for s in found.rig]
    assert rows == [("s_left", (0.0, 0.1, 1.0), 1.0), ("s_right", (0.0, -0.1, 1.0), 1.2)]
    moved = pe.Rig([found.rig["s_left"].moved(pe.Pose((0.5, 0.0, 1.5))), found.rig["s_right"]])
    pt.export_rig(moved, "urdf", tmp_path / "r.urdf", replace=True)
    again = pt.import_rig(tmp_path / "r.urdf").rig
    assert [s.pose for s in again] == [s.pose for s in moved], "in the one sensor"


def test_a_pose_that_is_none_is_refused(tmp_path):
    for bad in ("1 2 3", "1 2 3 0 0 x", "1 2 3 0 0 0 1"):
        block = f'<gazebo reference="mast">{FRONT}</gazebo>'.replace("0.5 0 0.25 0 0.3 0", bad)
        with pytest.raises(pe.InputError, match="sensor of mast, pose"):
            read(tmp_path, robot([MAST], block))


def test_links_are_sensors_by_name_joint_and_mass(tmp_path):
    """With masses and on housings; wheels, markers and nameless links are none, and told."""
    masses = ("base_link", "lidar_top", "lidar_base", "camera_front")
    found = read(tmp_path, robot(LINKS, masses=masses))
    assert {s.name: s.kind for s in found.rig} == {"lidar_top": "lidar", "camera_front": "camera"}
    assert found.rig["lidar_top"].pose.position == pytest.approx((0.0, 0.0, 1.8))
    text = " ".join(found.lines)
    for name in ("lidar_mount", "wheel_left", "antenna_marker", "imu_link", "top_plate", "shelf"):
        assert text.count(name) == 1, name
    assert "lidar_base" not in text, "the housing of what is read"
    rows = [row for row in LINKS if not row[1].startswith(("lidar", "camera"))]
    guessed = read(tmp_path, robot(rows))
    assert [sensor.name for sensor in guessed.rig] == ["shelf"], "no name says a sensor"
    assert any("taken as sensors" in line and "shelf" in line for line in guessed.lines)


def test_links_beside_gazebo_s_sensors_are_told(tmp_path):
    """A camera that Gazebo does not simulate; the LiDAR's own housing is none."""
    block = f'<gazebo reference="lidar_top">{FRONT}</gazebo>'
    found = read(tmp_path, robot(LINKS, block))
    assert [sensor.name for sensor in found.rig] == ["lidar_top"]
    (line,) = [line for line in found.lines if "Gazebo" in line]
    assert "camera_front" in line and "lidar" not in line
    imu = '<gazebo reference="base_link"><sensor name="i" type="imu"/></gazebo>'
    assert line in read(tmp_path, robot(LINKS, block, imu)).lines, "not all on the base are read"


def test_gazebo_s_sensors_on_links_that_are_not_there_are_told(tmp_path):
    blocks = "".join(f'<gazebo reference="{link}">{FRONT}</gazebo>' for link in ("mast", "gone"))
    found = read(tmp_path, robot([MAST], blocks))
    assert [sensor.name for sensor in found.rig] == ["mast"]
    (line,) = [line for line in found.lines if "gone" in line]
    assert line.startswith("left out, 1 ")


@pytest.mark.parametrize("name", ["car.urdf.xacro", "car.urdf"])
@pytest.mark.parametrize(
    "inside",
    [
        '<xacro:include filename="a.xacro"/><link name="a"/>',
        '<link name="${prefix}lidar"/>',
        '<link name="$(arg name)"/>',
    ],
)
def test_xacro_is_refused_by_what_to_run(inside, name, tmp_path):
    with pytest.raises(pe.InputError, match=rf"`xacro {name}`"):
        read(tmp_path, XACRO.format(inside), name)
    with pytest.raises(pe.InputError, match=rf"`xacro {name}`"):  # the prefix is not even declared
        read(tmp_path, f"<robot><xacro:if value='1'/>{inside}</robot>", name)


def azimuths_of(model):
    beams = model.directions
    level = beams[np.abs(beams[:, 2] - beams[0, 2]) < 1e-9]
    return np.sort(np.degrees(np.arctan2(level[:, 1], level[:, 0])))


@pytest.mark.parametrize(("fan", "channels"), pairs(FANS, [1, 3]))
def test_n_samples_are_n_minus_1_steps_apart(fan, channels, tmp_path):
    """SDF: `samples` from min_angle to max_angle, both included."""
    samples, low, high, azimuths = fan
    scan = SCAN.format(samples, math.radians(low), math.radians(high), channels)
    block = f'<gazebo reference="mast"><sensor name="f" type="lidar">{scan}</sensor></gazebo>'
    model = read(tmp_path, robot([MAST], block)).rig["mast"].model
    found = azimuths_of(model)
    found = np.where(found < -179.999, found + 360.0, found)
    expected = np.where(np.array(azimuths) < -179.999, 180.0, azimuths)
    assert np.sort(found) == pytest.approx(np.sort(expected), abs=1e-6)
    up = np.degrees(np.arcsin(model.directions[:, 2]))
    assert len(np.unique(up.round(6))) == channels and model.beam_count == channels * len(azimuths)


@pytest.mark.parametrize(("low", "high", "step"), SCANS)
def test_a_scan_comes_back_beam_by_beam(low, high, step, tmp_path):
    """And the file is what Gazebo divides into the same beams."""
    fov = (math.radians(low), math.radians(high))
    lidar = pe.Lidar(
        "own", np.radians([-2.0, 0.0, 2.0]), round(360 / step), 50.0, horizontal_fov=fov
    )
    rig = pe.Rig([pe.Sensor("roof", lidar, pe.Pose((0.0, 0.0, 1.8)))])
    text = rig_files(rig, "urdf")[0]["rig.urdf"].decode()
    scan = ElementTree.fromstring(text).find(".//horizontal")
    samples = int(scan.findtext("samples"))
    start, end = (math.degrees(float(scan.findtext(f"{name}_angle"))) for name in ("min", "max"))
    gazebo = np.linspace(start, end, samples)
    ours = azimuths_of(lidar)
    wrapped = np.sort((gazebo - ours[0] + 1e-6) % 360.0 + ours[0] - 1e-6)
    assert wrapped == pytest.approx(ours, abs=1e-6)
    again = read(tmp_path, text).rig["roof"].model
    assert azimuths_of(again) == pytest.approx(ours, abs=1e-6)
    assert again.beam_count == lidar.beam_count


def test_sdf_is_read_in_the_frame_of_its_model(tmp_path):
    """By hand: 0.5; 0.5 + 1.2 + 0.1; 2 + 0.2 up. Where the model is in its world is left out."""
    found = read(tmp_path, SDF, "car.sdf")
    rows = {s.name: (s.kind, s.pose.position) for s in found.rig}
    assert set(rows) == {"low", "eye", "rack::bar"}
    assert rows["low"] == ("lidar", (2.0, 0.0, 0.5))
    assert rows["eye"][0] == "camera"
    assert rows["eye"][1] == pytest.approx((0.3, 0.0, 1.8))
    assert rows["rack::bar"][1] == pytest.approx((0.0, 1.0, 2.2))
    assert found.rig["eye"].pose.rotation_deg == pytest.approx((0.0, 0.0, 90.0))
    text = " ".join(found.lines)
    assert "1 imu sensor (imu), 1 sonar sensor (nose)" in text and "model://wheel" in text


def test_sdf_with_a_frame_that_is_not_there_or_in_a_circle_is_refused(tmp_path):
    for old, new, words in (
        ('relative_to="roof"', 'relative_to="attic"', "attic"),
        ('attached_to="body"', 'attached_to="eye"', "circle"),
        ('name="house"', 'name="h"><link name="l"><sensor name="s" type="lidar"/></link></model>'
         '<model name="x"', "one model with sensors"),
        ('name="bar"><pose>', 'name="bar"><pose>1 ', "6 numbers"),
    ):  # fmt: skip
        with pytest.raises(pe.InputError, match=words):
            read(tmp_path, SDF.replace(old, new), "car.sdf")
