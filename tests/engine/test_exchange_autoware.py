"""An Autoware kit as its packages have it: read, and written over without a change to the rest."""

import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.exchange import read_vehicle_info

yaml = pytest.importorskip("yaml")

SIX = ("x", "y", "z", "roll", "pitch", "yaw")
KIT = {
    "camera0/camera_link": (0.10731, 0.56343, -0.27697, -0.025, 0.315, 1.035),
    "traffic_light_left_camera_link": (0.05, 0.0175, -0.1, 0.0, 0.0, 0.0),
    "velodyne_top_base_link": (0.0, 0.0, 0.0, 0.0, 0.0, 1.575),
    "velodyne_left_base_link": (0.0, 0.56362, -0.30555, -0.02, 0.71, 1.575),
    "gnss_link": (-0.1, 0.0, -0.2, 0.0, 0.0, 0.0),
    "tamagawa/imu_link": (0.0, 0.0, 0.0, 3.14159265359, 0.0, 3.14159265359),
}
BASE = {
    "sensor_kit_base_link": (0.9, 0.0, 2.0, -0.001, 0.015, -0.0364),
    "velodyne_rear_base_link": (-0.358, 0.0, 1.631, -0.02, 0.7281317, 3.141592),
}
"""Frames of the form of sample_sensor_kit_launch's (005bf85): names, order, both parents."""
MODELS = {
    "velodyne_top": "Velodyne VLS-128 Alpha Prime",
    "velodyne_left": "Velodyne VLP-16 Puck",
    "velodyne_rear": "Velodyne VLP-16 Puck",
    "camera0": "Autoware sample kit",
    "traffic_light_left_camera_link": "Autoware sample kit",
}
INFO = """/**:
  ros__parameters:
    wheel_radius: 0.383
    wheel_width: 0.235
    wheel_base: 2.79 # between front wheel center and rear wheel center
    wheel_tread: 1.64
    front_overhang: 1.0
    rear_overhang: 1.1
    left_overhang: 0.128
    vehicle_height: 2.5
"""


@pytest.fixture
def kit(tmp_path):
    """The folder of a kit, as PyYAML writes it."""
    for name, parent, frames in (
        ("sensors_calibration.yaml", "base_link", BASE),
        ("sensor_kit_calibration.yaml", "sensor_kit_base_link", KIT),
    ):
        table = {frame: dict(zip(SIX, values, strict=True)) for frame, values in frames.items()}
        text = yaml.safe_dump({parent: table}, sort_keys=False)
        (tmp_path / name).write_text(text)
    (tmp_path / "vehicle_info.param.yaml").write_text(INFO)
    return tmp_path


def read_kit(folder):
    """Both files as PyYAML reads them."""
    names = "sensors_calibration.yaml", "sensor_kit_calibration.yaml"
    return [yaml.safe_load((folder / name).read_text()) for name in names]


def test_a_sensor_that_moved_moves_in_its_own_frame_and_a_new_one_goes_into_the_kit(kit):
    reference = read_vehicle_info(kit / "vehicle_info.param.yaml")
    rig = pt.import_rig(kit, None, reference, MODELS).rig
    rear = next(each for each in rig if each.name == "velodyne_rear")
    x, y, z = rear.pose.position
    moved = pe.Sensor(rear.name, rear.model, pe.Pose((x, y, z + 0.1), rear.pose.rpy))
    extra = pe.Sensor("velodyne_new", rear.model, pe.Pose((0.0, 0.0, 2.2)))
    others = [each for each in rig if each is not rear]
    pt.export_rig(pe.Rig([*others, moved, extra]), "autoware", kit, reference, replace=True)
    base, inside = read_kit(kit)
    own = base["base_link"]["velodyne_rear_base_link"]
    assert own["z"] == pytest.approx(1.731, abs=1e-6) and own["x"] == pytest.approx(-0.358)
    assert list(inside["sensor_kit_base_link"])[-1] == "velodyne_new_base_link"
    again = pt.import_rig(kit, None, reference, MODELS | {"velodyne_new": rear.model.name}).rig
    assert again["velodyne_new"].pose.position == pytest.approx((0.0, 0.0, 2.2), abs=1e-9)


def test_a_new_kit_and_its_lenses_are_what_pyyaml_reads(kit):
    rig = pt.import_rig(kit, None, pe.Reference(-1.345, 0.383), MODELS).rig
    pt.export_rig(rig, "autoware", kit / "new", pe.Reference(-1.345, 0.383))
    base, inside = read_kit(kit / "new")
    assert list(base["base_link"]) == ["sensor_kit_base_link"]
    frames = inside["sensor_kit_base_link"]
    assert {"camera0/camera_link", "velodyne_left_base_link"} < set(frames)
    assert all(list(values) == list(SIX) for values in frames.values())
    info = yaml.safe_load((kit / "new" / "camera_info" / "camera0.yaml").read_text())
    assert (info["image_width"], info["image_height"]) == (800, 400)
    assert info["distortion_model"] == "plumb_bob" and len(info["camera_matrix"]["data"]) == 9
    assert info["projection_matrix"]["cols"] == 4 and info["camera_name"] == "camera0"


def test_the_vehicle_s_own_file_says_where_the_axles_are(kit):
    """4.89 m long, the rear axle 1.1 m from its end: 1.345 m behind the middle."""
    found = read_vehicle_info(kit / "vehicle_info.param.yaml")
    expected = (-1.345, 0.383, 2.79, 1.0, 1.1)
    keys = ("rear_axle_x", "rear_axle_z", "wheelbase", "front_overhang", "rear_overhang")
    assert [getattr(found, key) for key in keys] == pytest.approx(expected)
    (kit / "vehicle_info.param.yaml").write_text("/**:\n  ros__parameters:\n    wheel_base: 2\n")
    with pytest.raises(pe.InputError, match=r"ros__parameters\.wheel_radius"):
        read_vehicle_info(kit / "vehicle_info.param.yaml")
