"""What names of frames say: models, kinds, what is no sensor; and axes of cameras' frames."""

import itertools
import math

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_core.catalog import scan_above_base
from pe_core.sensors import coinciding
from pe_tools.advice import warnings
from pe_tools.exchange.frames import body_of_optical, optical_of_body
from pe_tools.exchange.sensor_names import MODEL_NAMES, model_by_name, said_kind
from tests.thorough import pairs

AXLE = pe.Reference(-1.3, 0.3)
KIT_AT = (1.3, 0.0, 1.7)
HALF = math.pi / 2.0
PUCK = "Velodyne VLP-16 Puck"
SAID = {
    "VLS128_TOP": "Velodyne VLS-128 Alpha Prime",
    "vlp32c": "Velodyne VLP-32C Ultra Puck",
    "velodyne_vlp16_left": PUCK,
    "lidarFrontVLP16": PUCK,
    "vlp_16_hi_res": "Velodyne VLP-16 Hi-Res",
    "rs16": "RoboSense RS-LiDAR-16",
    "rs_bpearl_left": "RoboSense RS-Bpearl",
    "xt32": "Hesai PandarXT-32 / XT32",
    "hesai_xt32m_rear": "Hesai XT32M2X",
    "pandar_40p_left": "Hesai Pandar40P",
    "pandar_qt_front": "Hesai PandarQT (QT64)",
    "at128-front": "Hesai AT128E2X",
    "os1_128": "Ouster OS1-128 nominal",
    "ars408_front": "Continental ARS408-21",
    "sensors16": None,
    "vlp160": None,
    "camera_16": None,
    "hesai_top": None,
}
KINDS = {
    "gnss": "gnss",
    "gnss_link": "gnss",
    "tamagawa/imu_link": "imu",
    "camera_imu_optical_frame": "imu",
    "base_link": "frame",
    "sensor_kit_base_link": "frame",
    "wheel_left": "wheel",
    "antenna_marker": "marker",
    "lidar_mount": "mount",
    "zed": "camera",
    "zed2i": "camera",
    "traffic_light_left_camera_link": "camera",
    "frontcam": "camera",
    "lidar_camera": "camera",
    "velodyne_top": "lidar",
    "lidarTop": "lidar",
    "rs16": "lidar",
    "front_radar": "radar",
    "esr": "radar",
    "uss_3": "ultrasonic",
    "top": None,
    "roof": None,
    "ears": None,
}
OPTICAL = {
    "FRONT/camera_link": (0.2, 0.0, -0.2, -1.5708, 0.0, -1.5708),
    "BACK/camera_link": (-1.6, 0.0, -0.5, -1.5708, 0.0, 1.5708),
    "low/camera_link": (0.0, 0.1, 0.0, -HALF - 0.4, 0.0, -HALF),
    "side/camera_link": (0.0, 0.5, 0.0, 0.0, 0.3, HALF),
    "down_camera_optical_link": (0.5, 0.0, 0.0, math.pi, 0.0, -HALF),
    "steep/camera_link": (0.5, 0.5, 0.0, -HALF - 1.1, 0.0, -HALF),
    "turned/camera_link": (0.5, 1.0, 0.0, math.pi - 0.1, 0.3, 0.0),
}
"""By roll, by roll, nose down by 0.4, in body axes, by name: z points down, y to the rear; nose
down by 1.1; in body axes upside down."""
STRAY = {
    "left_calibration.yaml": "image_width: 1920\nimage_height: 1280\ncamera_name: left\n",
    "rear_calibration.yaml": "other_unit_base_link:\n  a_base_link: {x: 0}\n",
    "odd_calibration.yaml": "a:\n  b:\n c: [\n",
}
INFO = (
    "image_width: 640\nimage_height: 480\ndistortion_model: {}\n"
    "camera_matrix: {{rows: 3, cols: 3, data: [400, 0, {}, 0, 400, 240, 0, 0, 1]}}\n"
    "distortion_coefficients: {{rows: 1, cols: 4, data: [0, 0, 0, 0]}}\n"
)
ODD = {
    "distortion_model": INFO.format("double_sphere", 320),
    "cx": INFO.format("plumb_bob", 700),  # of a calibration at another size
    "image_width": INFO.format("plumb_bob", 320).replace("640", "wide"),
    "line 1": "{",
}
CALL = "static_transform_publisher"
POSITIONAL = {
    "-0.5 0.7 1.5 0.1 0.2 0.3 base lidar": (0.3, 0.2, 0.1),
    "-0.5 0.7 1.5 0.1 0.2 0.3 base lidar 100": (0.3, 0.2, 0.1),
    "-0.5 0.7 1.5 0 0 0.6 0.8 base lidar": (0.0, 0.0, 2.0 * math.atan2(0.6, 0.8)),
    "-0.5 0.7 1.5 0 0 0.6 0.8 base lidar 100": (0.0, 0.0, 2.0 * math.atan2(0.6, 0.8)),
    "--x -0.5 --y 0.7 --z 1.5 --yaw 0.1 --frame-id base --child-frame-id lidar": (0, 0, 0.1),
}
"""Arguments, and roll, pitch, yaw: the order of a call without options is yaw, pitch, roll, or
qx, qy, qz, qw (tf2_ros and tf: static_transform_publisher; ROS 1 has a period in ms)."""
FORMS = {
    "a.launch.xml": '<launch><group><node pkg="tf2_ros" exec="{1}" name="a" args="{0}"/></group>'
    "</launch>",
    "b.launch.xml": '<launch><node args="{0}" name=\'it\' pkg="tf" type="{1}"/></launch>',
    "c.sh": "#!/bin/sh\nros2 run tf2_ros {1} {0}\n",
    "d.sh": "ros2 run tf2_ros {1} {0} &\n",
    "e.sh": "ros2 run tf2_ros {1} {0}; sleep 1\n",
    "f.sh": "ros2 run tf2_ros {1} {0} --ros-args -r __node:=it > log &\n",
    "g.launch": '<launch><node args="{0}" name="it" pkg="tf" type="{1}"/></launch>',
}
OPTICAL_YPR = "-1.5707963267948966 0 -1.5707963267948966"


def kit_of(folder, rows, comments=(), sensor_kit=KIT_AT):
    """Write an Autoware kit: frames of six numbers on a sensor kit that is not turned."""
    folder.mkdir(exist_ok=True)
    keys = ("x", "y", "z", "roll", "pitch", "yaw")

    def text(parent, frames):
        lines = [f"{parent}:"]
        for name, numbers in frames.items():
            comment = f"  # {dict(comments)[name]}" if name in dict(comments) else ""
            lines.append(f"  {name}:{comment}")
            lines += [f"    {key}: {v!r}" for key, v in zip(keys, numbers, strict=True)]
        return "\n".join(lines) + "\n"

    base = {"sensor_kit_base_link": (*sensor_kit, 0.0, 0.0, 0.0)}
    (folder / "sensors_calibration.yaml").write_text(text("base_link", base))
    (folder / "sensor_kit_calibration.yaml").write_text(text("sensor_kit_base_link", rows))
    return folder


def texts_of(folder):
    return {path.name: path.read_text() for path in folder.glob("*_calibration.yaml")}


def test_a_name_says_its_model_and_its_kind():
    assert {name: model_by_name(name) for name in SAID} == SAID
    assert {name: said_kind(name) for name in KINDS} == KINDS
    assert model_by_name("vlp16", "camera") is None, "of another kind"


def test_every_model_of_the_table_is_in_the_catalogue_and_each_spelling_is_of_one():
    spellings = [(text, model) for model, texts in MODEL_NAMES.items() for text in texts]
    assert len({text for text, _ in spellings}) == len(spellings)
    for text, model in spellings:
        assert catalog.load(model).name == model
        for join in ("", "_", "-", " "):
            name = text.replace(" ", join)
            assert model_by_name(f"left_{name}") == model
            assert model_by_name(name.upper()) == model


def test_what_is_no_sensor_is_left_out_of_a_kit_and_told(tmp_path):
    frames = ("gnss_base_link", "zed", "imu_base_link", "top_base_link", "base_link")
    rows = {name: (0.1 * k, 0.0, 0.0, 0.0, 0.0, 0.0) for k, name in enumerate(frames)}
    found = pt.import_rig(kit_of(tmp_path, rows), None, AXLE)
    assert {s.name: s.kind for s in found.rig} == {"zed": "camera", "top": "lidar"}
    assert set(found.to_choose) == {"zed", "top"}
    assert found.lines[0].startswith("left out: 1 gnss sensor (gnss), 1 imu sensor (imu), 1 frame")
    chosen = pt.import_rig(tmp_path, None, AXLE, {"gnss": PUCK})
    assert chosen.rig["gnss"].kind == "lidar", "unless a model is chosen for it"
    before = texts_of(tmp_path)
    pt.export_rig(chosen.rig, "autoware", tmp_path, AXLE, replace=True)
    assert texts_of(tmp_path) == before, "and is that frame of the kit"


def test_a_lidar_is_lifted_by_its_own_housing_and_a_stand_in_by_none(tmp_path):
    """The kit at 1.7 m: the frame is the scan's centre where no model is known."""
    rows = {name: (0.3 * k, 0.0, 0.0, 0.0, 0.0, 0.5) for k, name in enumerate(
        ("VLS128_TOP_base_link", "velodyne_left_base_link", "noted_base_link"))}  # fmt: skip
    kit = kit_of(tmp_path / "kit", rows, {"noted_base_link": "Hesai Pandar40P"}.items())
    found = pt.import_rig(kit, None, AXLE)
    assert found.rig["VLS128_TOP"].model.name == "Velodyne VLS-128 Alpha Prime"
    assert found.to_choose == ("velodyne_left",)
    heights = [sensor.pose.position[2] for sensor in found.rig]
    assert heights == pytest.approx([1.7 + 0.06611, 1.7, 1.7 + 0.047], abs=1e-9)
    assert scan_above_base("Velodyne VLS-128 Alpha Prime") == 0.06611
    before = texts_of(kit)
    for out in (tmp_path / "kept", kit):
        pt.export_rig(found.rig, "autoware", out, AXLE, into=kit, replace=out == kit)
        assert texts_of(out) == before
        again = pt.import_rig(out, None, AXLE).rig
        for ours, theirs in zip(found.rig, again, strict=True):
            assert theirs.pose.position == pytest.approx(ours.pose.position, abs=1e-9)


def test_an_optical_frame_of_a_kit_looks_along_z(tmp_path):
    kit = kit_of(tmp_path / "kit", OPTICAL)
    found = pt.import_rig(kit, None, AXLE)
    axes = {s.name: s.pose.ground_from_sensor[:, (0, 2)].T.tolist() for s in found.rig}
    expected = {
        "FRONT": [[1, 0, 0], [0, 0, 1]],
        "BACK": [[-1, 0, 0], [0, 0, 1]],
        "low": [[math.cos(0.4), 0, -math.sin(0.4)], [math.sin(0.4), 0, math.cos(0.4)]],
        "side": [[0, math.cos(0.3), -math.sin(0.3)], [0, math.sin(0.3), math.cos(0.3)]],
        "down_camera_optical_link": [[0, 0, -1], [1, 0, 0]],
        "steep": [[math.cos(1.1), 0, -math.sin(1.1)], [math.sin(1.1), 0, math.cos(1.1)]],
        "turned": pe.Pose((0, 0, 0), (math.pi - 0.1, 0.3, 0.0)).ground_from_sensor[:, (0, 2)].T,
    }
    for name, rows in expected.items():
        assert np.abs(np.array(axes[name]) - rows).max() < 1e-5, name
    (line,) = [line for line in found.lines if "optical" in line and "taken" in line]
    assert line.startswith("FRONT, BACK, low, down_camera_optical_link, steep: ")


def test_an_optical_frame_of_a_kit_is_written_as_one(tmp_path):
    """Unmoved it is as it was; moved it moves, and looks where it looked."""
    kit = kit_of(tmp_path / "kit", OPTICAL)
    found = pt.import_rig(kit, None, AXLE)
    before = texts_of(kit)
    pt.export_rig(found.rig, "autoware", kit, AXLE, replace=True)
    assert texts_of(kit) == before
    for pitch in (11.0, 30.0, 70.0, -89.0, 11.0):
        turned = pe.Pose.from_degrees((0.4, 0.1, 1.4), (2.0, pitch, 33.0))
        moved = pe.Rig([found.rig["FRONT"].moved(turned), *list(found.rig)[1:]])
        pt.export_rig(moved, "autoware", kit, AXLE, replace=True)
        again = pt.import_rig(kit, None, AXLE).rig["FRONT"].pose
        assert again.position == pytest.approx(turned.position, abs=1e-9)
        assert np.abs(again.ground_from_sensor - turned.ground_from_sensor).max() < 1e-9, pitch


def test_optical_axes_and_body_axes_are_each_other_s():
    for rpy in itertools.product((-3.0, -1.2, 0.0, 0.4, 1.5), repeat=3):
        pose = pe.Pose((1.0, 2.0, 3.0), rpy)
        again = body_of_optical(optical_of_body(pose))
        assert np.abs(again.ground_from_sensor - pose.ground_from_sensor).max() < 1e-12
        seen = optical_of_body(pose).ground_from_sensor
        assert seen[:, 2] == pytest.approx(pose.ground_from_sensor[:, 0]), "z is forward"
        assert seen[:, 1] == pytest.approx(-pose.ground_from_sensor[:, 2]), "y is down"


@pytest.mark.parametrize("name", STRAY)
def test_a_stray_file_is_told_and_the_kit_is_read(name, tmp_path):
    kit = kit_of(tmp_path, {"top_base_link": (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)})
    (kit / name).write_text(STRAY[name])
    found = pt.import_rig(kit, None, AXLE)
    assert [sensor.name for sensor in found.rig] == ["top"]
    assert found.rig["top"].pose.position == pytest.approx((0.0, 0.0, 1.7))
    (line,) = [line for line in found.lines if name in line]
    assert line.endswith("the file is not read")
    pt.export_rig(found.rig, "autoware", kit, AXLE, replace=True)
    assert (kit / name).read_text() == STRAY[name]


@pytest.mark.parametrize("field", ODD)
def test_an_odd_lens_is_told_and_its_file_is_kept(field, tmp_path):
    frames = {f"{name}/camera_link": (0.1, k, 0.0, 0.0, 0.0, 0.0) for k, name in enumerate("ab")}
    kit = kit_of(tmp_path, frames)
    (kit / "camera_info").mkdir()
    (kit / "camera_info" / "a.yaml").write_text(ODD[field])
    (kit / "camera_info" / "b.yaml").write_text(INFO.format("plumb_bob", 320))
    found = pt.import_rig(kit, None, AXLE)
    assert found.to_choose == ("a",) and found.rig["b"].model.width == 640
    assert any(f"camera_info/a.yaml: {field}" in line for line in found.lines)
    own = pe.Sensor("a", catalog.load("KITTI cam2"), found.rig["a"].pose)
    for rig in (found.rig, pe.Rig([own, found.rig["b"]])):
        _, lines = pt.export_rig(rig, "autoware", kit, AXLE, replace=True)
        assert (kit / "camera_info" / "a.yaml").read_text() == ODD[field]
        told = [line for line in lines if line.startswith("a: its camera_info")]
        assert bool(told) == (rig is not found.rig), "the stand-in was not of the file"


def test_sensors_of_one_kind_at_one_place_are_told(tmp_path):
    """Alternatives count each; cameras of a ring drawn at one point look apart."""
    rows = {f"{name}_base_link": (0.0, 0.0, 0.005 * k, 0.0, 0.0, 1.0 * k) for k, name in enumerate(
        ("velodyne_top", "hesai_top"))}  # fmt: skip
    rows |= {f"c{k}/camera_link": (0.0, 0.0, 0.0, 0.0, 0.0, 1.0 * k) for k in range(3)}
    rows["c3/camera_link"] = (0.0, 0.0, 0.0, 0.0, 0.1, 2.1)
    found = pt.import_rig(kit_of(tmp_path, rows), None, AXLE)
    groups = [[s.name for s in group] for group in coinciding(list(found.rig))]
    assert groups == [["velodyne_top", "hesai_top"], ["c2", "c3"]]
    told = [line.split(":")[0] for line in found.lines if "same place" in line]
    assert told == ["velodyne_top, hesai_top", "c2, c3"]
    space = pe.PerceptionSpace()
    found_advice = warnings(found.rig, None, space, pe.Prior.uniform())
    advice = [a.subject for a in found_advice if a.code == "coincides"]
    assert advice == ["velodyne_top", "c2"]


@pytest.mark.parametrize(("args", "name"), pairs(POSITIONAL, FORMS))
def test_a_transform_is_read_in_each_form(args, name, tmp_path):
    (tmp_path / name).write_text(FORMS[name].format(args, CALL))
    (lidar,) = pt.import_rig(tmp_path / name).rig
    assert lidar.name == "lidar" and lidar.pose.position == (-0.5, 0.7, 1.5)
    assert lidar.pose.rpy == pytest.approx(POSITIONAL[args], abs=1e-12)


def test_a_transform_of_too_few_numbers_is_refused(tmp_path):
    for args in ("1 2 3 0 0 base lidar", "1 2 3 0 0 0 base", "1 2 3 0 0 0 0 0 base lidar"):
        (tmp_path / "a.sh").write_text(f"{CALL} {args}\n")
        with pytest.raises(pe.InputError, match=r"transform 1: .*two frames"):
            pt.import_rig(tmp_path / "a.sh", "ros")


def calls(*rows):
    nodes = (f'<node exec="{CALL}" args="{row}"/>' for row in rows)
    return f"<launch>{''.join(nodes)}</launch>"


def test_optical_frames_of_transforms(tmp_path):
    """On its own it is a camera; two of a link are two; an IMU's and a wheel's are none."""
    path = tmp_path / "rig.launch.xml"
    path.write_text(
        calls(
            f"1 0 1.5 {OPTICAL_YPR} base_link camera_front_optical_frame",
            "0 0 2 0 0 0 base_link stereo",
            f"0 0.1 0 {OPTICAL_YPR} stereo left_optical_frame",
            f"0 -0.1 0 {OPTICAL_YPR} stereo right_optical_frame",
            "0 0 1 0.5 0 0 base_link eye",
            f"0 0 0.1 {OPTICAL_YPR} eye eye_optical",
            "0 0 1 0 0 0 base_link wheel_left",
        )
    )
    found = pt.import_rig(path)
    places = {s.name: s.pose.position for s in found.rig if s.kind == "camera"}
    assert places.pop("eye") == pytest.approx((0.0, 0.0, 1.1)), "that of its optical frame"
    assert places.pop("camera_front") == pytest.approx((1.0, 0.0, 1.5))
    assert places == {"left": (0.0, 0.1, 2.0), "right": (0.0, -0.1, 2.0), "stereo": (0, 0, 2)}
    for name, yaw in (("camera_front", 0), ("left", 0), ("eye", math.degrees(0.5))):
        assert found.rig[name].pose.rotation_deg == pytest.approx((0, 0, yaw), abs=1e-5)
    assert found.lines[0].startswith("left out: 1 wheel (wheel_left)")
