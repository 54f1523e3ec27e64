"""Frames of robots: names of their own, links that Gazebo keeps, the origin, other kinds."""

import re
from xml.etree import ElementTree

import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.exchange import import_rig, rig_files, ros
from pe_tools.formats.xml_text import without_comments

PUCK = "Velodyne VLP-16 Puck"
IMU = (
    '<gazebo reference="imu_link"><sensor name="i" type="imu"><update_rate>100</update_rate>'
    "</sensor></gazebo>"
)
ROBOT = f"""<robot name="cart">
  <link name="base_link"/><link name="base_footprint"/>
  <link name="roof"/><link name="imu_link"/><link name="front_sonar"/>
  <joint name="f" type="fixed"><parent link="base_link"/><child link="base_footprint"/>
    <origin xyz="0 0 -0.35"/></joint>
  <joint name="r" type="fixed"><parent link="base_link"/><child link="roof"/>
    <origin xyz="0.2 0 1.5" rpy="0 0.1 0"/></joint>
  <joint name="i" type="fixed"><parent link="roof"/><child link="imu_link"/>
    <origin xyz="0 0 0.1"/></joint>
  <joint name="o" type="fixed"><parent link="base_link"/><child link="front_sonar"/>
    <origin xyz="2 0 0.3"/></joint>
  <gazebo reference="roof"><sensor name="l" type="gpu_lidar"/></gazebo>
  <gazebo reference="front_sonar"><sensor name="r" type="sonar"><range>80</range></sensor></gazebo>
  {IMU}
</robot>
"""
CALL = '<node exec="static_transform_publisher" args="--frame-id {} --child-frame-id {}{}"/>'


def sensor(name, model=PUCK, position=(0.5, 0.1, 1.5), rotation=(3, 10, 20)):
    return pe.Sensor(name, pe.catalog.load(model), pe.Pose.from_degrees(position, rotation))


def test_gazebo_keeps_every_link_where_it_is():
    """What its converter drops or fuses: links without a mass, or on joints not to be preserved."""
    files, _ = rig_files(pe.Rig([sensor("roof"), sensor("cam", "KITTI cam2")]), "urdf")
    robot = ElementTree.fromstring(files["rig.urdf"])
    links = [link.get("name") for link in robot.iter("link")]
    assert links == ["base_link", "roof", "cam", "cam_optical"]
    for link in robot.iter("link"):
        if link.get("name") in links and link.find("inertial") is not None:
            assert float(link.find("inertial/mass").get("value")) > 1e-5
            inertia = link.find("inertial/inertia").attrib
            assert all(float(inertia[key]) > 0.0 for key in ("ixx", "iyy", "izz"))
        assert link.find("inertial") is not None
    told = {}
    for block in robot.iter("gazebo"):
        told.setdefault(block.get("reference"), set()).update(child.tag for child in block)
    assert all("turnGravityOff" in told[name] for name in links)
    assert all("preserveFixedJoint" in told[f"{name}_joint"] for name in links[1:])


@pytest.mark.parametrize("name", ["urdf", "ros"])
def test_frames_of_sensors_and_of_the_format_stay_apart(name, tmp_path):
    """By any order of names; each comes back with its own kind and place."""
    rig = pe.Rig(
        [
            sensor("cam_optical", PUCK, (1, 0, 1)),
            sensor("cam", "KITTI cam2", (2, 0, 1)),
            sensor("base_link", "KITTI cam2", (3, 0, 1)),
            sensor("base_link_2", PUCK, (4, 0, 1)),
        ]
    )
    paths, lines = pt.export_rig(rig, name, tmp_path / "out")
    text = paths[0].read_text()
    frames = re.findall(r'(?:<link name="|--child-frame-id )([\w/]+)', text)
    assert len(frames) == len(set(frames)) and "cam_optical" in frames
    assert "cam_optical: called cam_optical_sensor, which is a legal frame of its own" in lines
    found = import_rig(paths[0], name).rig
    assert [each.name for each in found] == [
        "cam_optical_sensor",
        "cam",
        "base_link_2",
        "base_link_2_2",
    ]
    for ours, theirs in zip(rig, found, strict=True):
        assert theirs.pose.position == pytest.approx(ours.pose.position, abs=1e-9)
        assert name == "ros" or theirs.kind == ours.kind


def test_a_robot_s_origin_is_the_link_on_the_ground_else_its_root(tmp_path):
    (tmp_path / "r.urdf").write_text(ROBOT)
    found = import_rig(tmp_path / "r.urdf")
    assert found.rig["roof"].pose.position == pytest.approx((0.2, 0.0, 1.85))
    assert any("roof: taken in base_footprint, which is on the ground" in s for s in found.lines)
    (tmp_path / "r.urdf").write_text(ROBOT.replace("base_footprint", "under"))
    found = import_rig(tmp_path / "r.urdf")
    assert found.rig["roof"].pose.position == pytest.approx((0.2, 0.0, 1.5))
    assert any("taken in the robot's root, base_link; if that is not" in s for s in found.lines)
    ours, _ = rig_files(found.rig, "urdf")
    (tmp_path / "ours.urdf").write_bytes(ours["rig.urdf"])
    assert not any("taken in" in s for s in import_rig(tmp_path / "ours.urdf").lines)


def test_a_frame_with_an_optical_frame_below_it_is_a_camera(tmp_path):
    path = tmp_path / "rig.launch.xml"
    frames = {"eye": "base_link", "eye_optical": "eye", "ears": "base_link"}
    calls = "".join(CALL.format(parent, name, "") for name, parent in frames.items())
    path.write_text(f"<launch>{calls}</launch>")
    assert [(s.name, s.kind) for s in ros.read(path).sensors] == [("eye", "camera"), ("ears", None)]


def test_comments_are_left_out_wherever_they_begin():
    for before in range(8):
        text = "-" * before + "<!--a--><!--b-->x<!-- -- > -->y"
        plain = without_comments(text)
        assert plain.split() == ["-" * before, "x", "y"][not before :] and len(plain) == len(text)
    assert without_comments("a<!-- no\nend") == "a       \n   "
