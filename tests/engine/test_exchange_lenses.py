"""Lenses in the files of other programs: what their numbers mean, by hand."""

import json
import math

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.sensors.camera import BrownConrady, Camera

AXLE = pe.Reference(-1.31, 0.33)
WIDTH = 1920
HEIGHT = 1080
LAUNCH = (
    '<node exec="static_transform_publisher" args="--frame-id base_link --child-frame-id eye"/>'
)
INFO = """image_width: 640
image_height: 480   # as camera_calibration writes it
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [400.0, 0.0, 320.0,
         0.0, 410.0, 240.0,
         0.0, 0.0, 1.0]
distortion_model: {model}
distortion_coefficients:
  rows: 1
  cols: 5
  data: [{values}]
"""
COEFFICIENTS = "distortion_coefficients.data"
BAD_INFO = [
    ("distortion_model", ("fov", "0.9, 0, 0, 0")),
    (COEFFICIENTS, ("plumb_bob", "0.1, 0.2")),
    (COEFFICIENTS, ("plumb_bob", "0.1, 0.2, 0, 0, 0, 0.5")),
    (COEFFICIENTS, ("plumb_bob", "0.1, a, 0, 0")),
]


def camera(name, lens):
    pose = pe.Pose.from_degrees((1.5, 0.1, 1.3), (0.3, 2.5, -0.4))
    return pe.Sensor(name, Camera(f"own {name}", WIDTH, HEIGHT, lens=lens), pose)


def info_of(folder, model, values):
    (folder / "rig.launch.xml").write_text(LAUNCH)
    (folder / "camera_info").mkdir(exist_ok=True)
    (folder / "camera_info" / "eye.yaml").write_text(INFO.format(model=model, values=values))
    return folder / "rig.launch.xml"


@pytest.mark.parametrize(
    ("model", "values", "right"),
    [
        # 0.5 to the right: r^2 = 0.25, so 0.5 (1 - 0.1 / 4 + 0.02 / 16) = 0.488125
        ("plumb_bob", "-0.1, 0.02, 0, 0, 0", 320 + 400 * 0.488125),
        # and of a denominator 1 + 0.2 / 4 = 1.05
        ("rational_polynomial", "-0.1, 0.02, 0, 0, 0, 0.2, 0, 0", 320 + 400 * 0.488125 / 1.05),
        # theta = atan 0.5 = 0.4636476: theta (1 + 0.1 theta^2)
        ("equidistant", "0.1, 0, 0, 0", 320 + 400 * 0.4636476090 * (1 + 0.1 * 0.2149691055)),
    ],
)
def test_ros_intrinsics_are_read_right(model, values, right, tmp_path):
    (eye,) = pt.import_rig(info_of(tmp_path, model, values)).rig
    assert (eye.kind, eye.model.width, eye.model.height) == ("camera", 640, 480)
    x, y = eye.model.projection.project(np.array([2.0]), np.array([-1.0]), np.array([0.0]))
    assert (x[0], y[0]) == (pytest.approx(right, abs=1e-6), 240.0)


def test_a_lens_that_folds_sees_as_far_as_it_does_not(tmp_path):
    """r (1 - 0.9 r^2) turns back where 1 = 2.7 r^2: r = 0.60858, 31.32 deg from the axis."""
    found = pt.import_rig(info_of(tmp_path, "plumb_bob", "-0.9, 0, 0, 0, 0"))
    fov = math.degrees(found.rig["eye"].model.projection.fov)
    assert fov == pytest.approx(2.0 * math.degrees(math.atan(math.sqrt(1 / 2.7))), abs=0.3)
    (line,) = found.lines
    assert line.startswith("eye: its lens folds inside the picture; what is farther than 31.")


@pytest.mark.parametrize(("field", "given"), BAD_INFO)
def test_bad_intrinsics_are_left_out_and_the_line_names_the_field(field, given, tmp_path):
    """The rig is read: one odd lens does not refuse a whole kit."""
    found = pt.import_rig(info_of(tmp_path, *given))
    assert found.to_choose == ("eye",)
    assert any(f"camera_info/eye.yaml: {field}: expected" in line for line in found.lines)


def rig_json(folder, **properties):
    common = {"Model": "ftheta", "cx": "960", "cy": "604", "width": "1920", "height": "1208"}
    eye = {"name": "eye", "protocol": "camera.gmsl", "properties": common | properties}
    eye["nominalSensor2Rig_FLU"] = {"roll-pitch-yaw": [0, 0, 0], "t": [1, 0, 1.5]}
    path = folder / "rig.json"
    path.write_text(json.dumps({"rig": {"sensors": [eye]}}))
    return path


def test_driveworks_polynomial_of_pixels_is_turned_round(tmp_path):
    """500 px from the middle: 0.5 + 2e-10 * 500^3 = 0.525 rad from the axis."""
    ahead = np.array([math.cos(0.525)]), np.array([0.0]), np.array([-math.sin(0.525)])
    for properties in (
        {"polynomial": "0 0.001 0 2e-10", "polynomial-type": "pixeldistance-to-angle"},
        {"polynomial": "0 0.001 0 2e-10"},
        {"bw-poly": "0 0.001 0 2e-10"},
    ):
        (eye,) = pt.import_rig(rig_json(tmp_path, **properties), reference=AXLE).rig
        x, y = eye.model.projection.project(*ahead)
        assert (x[0], y[0]) == (pytest.approx(960.0), pytest.approx(1104.0, abs=0.02))


def test_driveworks_pinhole_is_bent_as_its_file_says(tmp_path):
    """A ray at (0.3, 0.4) of depth 1: r2 = 0.25, and 1 - 0.29 r2 + 0.08 r2^2 - 0.001 r2^3."""
    scale = 1.0 - 0.29 * 0.25 + 0.08 * 0.0625 - 0.001 * 0.015625
    for bent in (
        {"distortion": "-0.29 0.08 -0.001"},
        {"k1": "-0.29", "k2": "0.08", "k3": "-0.001"},
    ):
        path = rig_json(tmp_path, fx="1000", fy="1000", Model="pinhole", **bent)
        (eye,) = pt.import_rig(path, reference=AXLE).rig
        x, y = eye.model.projection.project(np.array([1.0]), np.array([-0.3]), np.array([-0.4]))
        middle = eye.model.projection.cx, eye.model.projection.cy
        assert x[0] - middle[0] == pytest.approx(300.0 * scale)
        assert y[0] - middle[1] == pytest.approx(400.0 * scale)


def test_driveworks_corrections_are_applied(tmp_path):
    """NVIDIA's own example: R = R_nominal R_correction, t = t_nominal + t_correction."""
    path = rig_json(tmp_path, fx="1000", fy="1000", Model="pinhole")
    data = json.loads(path.read_text())
    (eye,) = data["rig"]["sensors"]
    eye["nominalSensor2Rig_FLU"] = {"roll-pitch-yaw": [0, 0, 90], "t": [1.0, -0.1, 1.5]}
    eye["correction_sensor_R_FLU"] = {"roll-pitch-yaw": [0.0, 4.74, 0.0]}
    eye["correction_rig_T"] = [0.0, 0.0, 0.3275]
    path.write_text(json.dumps(data))
    (found,) = pt.import_rig(path, reference=AXLE).rig
    assert found.pose.position == pytest.approx((1.0 - 1.31, -0.1, 1.8275))
    down = math.radians(4.74)  # to the left, and nose down in the sensor's own axes
    forward = found.pose.ground_from_sensor[:, 0]
    assert forward == pytest.approx((0.0, math.cos(down), -math.sin(down)), abs=1e-12)
    eye["correction_rig_T"] = [0.0, "x", 0.0]
    path.write_text(json.dumps(data))
    with pytest.raises(pe.InputError, match="correction_rig_T"):
        pt.import_rig(path, reference=AXLE)


def test_gazebo_s_distortion_centre_is_the_principal_point(tmp_path):
    lens = BrownConrady(fx=930.0, fy=930.0, cx=0.485 * 1920, cy=0.526 * 1080, fov=None, k1=-0.02)
    (path,), _ = pt.export_rig(pe.Rig([camera("eye", lens)]), "urdf", tmp_path / "rig.urdf")
    text = path.read_text()
    center = text.partition("<center>")[2].partition("</center>")[0]
    assert [float(v) for v in center.split()] == pytest.approx([0.485, 0.526])
    intrinsics = text[text.index("<lens>") : text.index("</lens>") + 7]
    path.write_text(text.replace(intrinsics, ""))
    (eye,) = pt.import_rig(path).rig
    found = eye.model.projection
    assert (found.cx, found.cy) == pytest.approx((0.485 * 1920, 0.526 * 1080))
