"""Rigs go out in other programs' formats and come back; and known files of these are read right."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.files import is_reserved, marked
from pe_core.geometry.poses import rotation_matrix
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_tools.cli.exchange_verbs import FILE_NAMES
from pe_tools.exchange import RIG_FORMATS, format_of_file, rig_files
from pe_tools.exchange.frames import from_quaternion, quaternion
from tests.engine.refusals import wrongly_refused
from tests.engine.test_files import FORMULAS

AXLE = pe.Reference(-1.31, 0.33)
WITHIN = 1e-6
PUCK = "Velodyne VLP-16 Puck"


def sensor(name, model, position, rotation=(0, 0, 0)):
    return pe.Sensor(name, pe.catalog.load(model), pe.Pose.from_degrees(position, rotation))


MIXED = pe.Rig(
    [
        sensor("roof", "Pandar64", (-0.43, 0, 1.8), (0.5, -1.25, 12)),
        sensor("side left", PUCK, (1.2, 0.9, 0.8), (1, 40.7, 90.1)),
        sensor("front cam", "Front 120 deg 8 MP", (1.5, 0.1, 1.3), (0.3, 2.5, -0.4)),
        sensor("rear cam", "KITTI cam2", (-2.2, -0.1, 1.0), (0, 10, 180)),
        sensor("up cam", "KITTI cam2", (0, 0, 2.0), (20, -90, 0)),
    ]
)
ONE_WAY = pe.Rig(
    [
        sensor("velodyne", PUCK, (0.1, 0.0, 1.73), (1, 2, 3)),
        *(sensor(f"c{k}", "KITTI cam2", (0.5, -0.5 * k, 1.6), (0.3, 2.5, -0.4)) for k in range(3)),
    ]
)
FEW_BEAMS = pe.Lidar("few beams", np.radians([-20, -7, 3]), 36, 80.0, np.radians([0, 2, 0]))
FEW = pe.Rig([pe.Sensor("roof", FEW_BEAMS, MIXED["roof"].pose), MIXED["front cam"]])
RIGS = {name: {"kitti": ONE_WAY, "osi": FEW}.get(name, MIXED) for name in RIG_FORMATS}
CHOSEN = {
    "autoware": {"side_left": PUCK, "roof": "Pandar64"},
    "ros": {"front_cam": "Front 120 deg 8 MP", "side_left": PUCK},
}


def there_and_back(name, folder):
    """A rig written in a format, and what is read of it."""
    if name == "argoverse2":
        pytest.importorskip("pyarrow", reason="of the extra argoverse")
    rig = RIGS[name]
    paths, _ = pt.export_rig(rig, name, folder, AXLE)
    placed = rig["velodyne"].pose if name == "kitti" else None
    file = folder if len(paths) > 1 else paths[0]
    return rig, pt.import_rig(file, None, AXLE, CHOSEN.get(name), placed)


@pytest.mark.parametrize("name", RIG_FORMATS)
def test_a_rig_goes_out_and_comes_back_where_it_was(name, tmp_path):
    rig, found = there_and_back(name, tmp_path)
    assert len(found.rig) == len(rig)
    for ours, theirs in zip(rig, found.rig, strict=True):
        assert theirs.kind == ours.kind
        assert np.abs(np.subtract(theirs.pose.position, ours.pose.position)).max() < WITHIN
        turned = theirs.pose.ground_from_sensor - ours.pose.ground_from_sensor
        assert np.abs(turned).max() < WITHIN


@pytest.mark.parametrize("name", ["csv", "urdf", "driveworks"])
def test_formats_with_a_place_for_the_model_bring_it_back(name, tmp_path):
    rig, found = there_and_back(name, tmp_path)
    assert [s.model.name for s in found.rig] == [s.model.name for s in rig]
    assert found.to_choose == ()


@pytest.mark.parametrize("name", ["urdf", "carla", "osi", "driveworks", "nuscenes", "kitti"])
def test_a_camera_keeps_its_picture_where_a_format_has_it(name, tmp_path):
    rig, found = there_and_back(name, tmp_path)
    pairs = [(a.model, b.model) for a, b in zip(rig, found.rig, strict=True) if a.kind == "camera"]
    for ours, theirs in pairs:
        assert (theirs.width, theirs.height) == (ours.width, ours.height)
        assert theirs.hfov == pytest.approx(ours.hfov, abs=1e-9)


def test_osi_has_every_beam(tmp_path):
    rig, found = there_and_back("osi", tmp_path)
    ours, theirs = rig["roof"].model, found.rig["lidar_0"].model
    assert theirs.max_range == ours.max_range
    assert np.abs(theirs.directions - ours.directions).max() < 1e-8


def test_carla_brings_back_even_channels_and_says_what_it_cannot(tmp_path):
    _, lines = rig_files(MIXED, "carla")
    told = [line for line in lines if "spaces channels evenly" in line]
    assert [line.split(":")[0] for line in told] == ["roof"], "a Pandar64's channels are uneven"
    _, found = there_and_back("carla", tmp_path)
    puck, model = found.rig["side_left"].model, MIXED["side left"].model
    assert np.abs(puck.elevations - np.sort(model.elevations)).max() < 1e-9
    assert puck.beam_count == model.beam_count and puck.max_range == model.max_range


def test_a_lens_keeps_its_middle_and_its_distortion_is_reported(tmp_path):
    rig = pe.Rig([sensor("wide", "PandaSet wide", (1.5, 0, 1.6))])
    (path,), lines = pt.export_rig(rig, "driveworks", tmp_path / "rig.json", AXLE)
    assert lines == ["wide: the distortion (brown-conrady) of PandaSet wide is left out of "
                     "DriveWorks rig.json"]  # fmt: skip
    data = json.loads(path.read_text())
    data["rig"]["sensors"][0]["parameter"] = ""  # else its model is known, lens and all
    path.write_text(json.dumps(data))
    ours = rig["wide"].model.projection
    theirs = pt.import_rig(path, reference=AXLE).rig["wide"].model.projection
    assert (theirs.fx, theirs.fy, theirs.cx, theirs.cy) == (ours.fx, ours.fy, ours.cx, ours.cy)


# --- files of other programs, by hand -------------------------------------------------------------


def test_nuscenes_own_front_camera(tmp_path):
    """As published; its pose in our axes by hand: nose down 0.32 deg, and as far to the left."""
    (tmp_path / "sensor.json").write_text(
        '[{"token": "s", "channel": "CAM_FRONT", "modality": "camera"}]'
    )
    turn = [0.4998015430569128, -0.5030316162024876, 0.4997798114386805, -0.49737083824542755]
    row = {
        "token": "c",
        "sensor_token": "s",
        "translation": [1.70079118954, 0.0159456324149, 1.51095763913],
        "rotation": turn,
        "camera_intrinsic": [[1266.417203, 0, 816.267020], [0, 1266.417203, 491.507065], [0, 0, 1]],
    }
    (tmp_path / "calibrated_sensor.json").write_text(json.dumps([row]))
    found = pt.import_rig(tmp_path, reference=pe.Reference(-1.38, 0.3))
    camera = found.rig["CAM_FRONT"]
    assert camera.pose.position == pytest.approx((0.32079118954, 0.0159456324149, 1.51095763913))
    assert camera.pose.rotation_deg == pytest.approx((-0.046, 0.323, 0.325), abs=2e-3)
    # the row through the principal point, 816.267 px of 1600
    hfov = math.atan(816.26702 / 1266.417203) + math.atan((1600 - 816.26702) / 1266.417203)
    assert (camera.model.width, camera.model.height) == (1600, 900)
    assert camera.model.hfov == pytest.approx(hfov, abs=1e-9)
    assert found.lines == ("CAM_FRONT: no size in the file; 1600 x 900 px is usual there",)


def test_kitti_s_own_calibration(tmp_path):
    """Camera 2 of the object set: 0.33 m before the LiDAR, 6 cm to the side of the first one."""
    (tmp_path / "calib.txt").write_text(
        "P0: 721.5377 0 609.5593 0 0 721.5377 172.854 0 0 0 1 0\n"
        "P2: 721.5377 0 609.5593 44.85728 0 721.5377 172.854 0.2163791 0 0 1 0.002745884\n"
        "R0_rect: 0.9999239 0.00983776 -0.007445048 -0.009869795 0.9999421 -0.004278459 "
        "0.007402527 0.004351614 0.9999631\n"
        "Tr_velo_to_cam: 0.007533745 -0.9999714 -0.000616602 -0.004069766 0.01480249 0.0007280733 "
        "-0.9998902 -0.07631618 0.9998621 0.00752379 0.01480755 -0.2717806\n"
        "Tr_imu_to_velo: 1 0 0 0 0 1 0 0 0 0 1 0\n"
    )
    found = pt.import_rig(tmp_path / "calib.txt", placed=pe.Pose((0.0, 0.0, 1.73)))
    first, second = found.rig["camera_0"], found.rig["camera_2"]
    assert (first.model.width, first.model.height) == (1242, 375)
    assert first.pose.position == pytest.approx((0.27, 0.0, 1.65), abs=0.01)
    apart = math.dist(first.pose.position, second.pose.position)
    assert apart == pytest.approx(0.06, abs=1e-3)
    assert first.pose.rotation_deg == pytest.approx((0, 0, 0), abs=1.5)


def test_an_autoware_kit(tmp_path):
    """The form of the sample kit: comments, a frame beside the kit, a VLP-16 on its foot."""
    (tmp_path / "sensors_calibration.yaml").write_text(
        "base_link:\n  sensor_kit_base_link:\n    x: 0.9\n    y: 0.0\n    z: 2.0\n"
        "    roll: -0.001\n    pitch: 0.015\n    yaw: -0.0364\n"
        "  velodyne_rear_base_link:   # behind\n    x: -0.358\n    y: 0.0\n    z: 1.631\n"
        "    roll: -0.02\n    pitch: 0.7281317\n    yaw: 3.141592\n"
    )
    (tmp_path / "sensor_kit_calibration.yaml").write_text(
        "sensor_kit_base_link:\n  camera0/camera_link:\n    x: 0.10731\n    y: 0.56343\n"
        "    z: -0.27697\n    roll: -0.025\n    pitch: 0.315\n    yaw: 1.035\n"
        "  velodyne_top_base_link:\n    x: 0.0\n    y: 0.0\n    z: 0.0\n    roll: 0.0\n"
        "    pitch: 0.0\n    yaw: 1.575\n  gnss_link:\n    x: -0.1\n    y: 0.0\n    z: -0.2\n"
        "    roll: 0.0\n    pitch: 0.0\n    yaw: 0.0\n"
    )
    models = {"velodyne_top": PUCK, "velodyne_rear": PUCK}
    found = pt.import_rig(tmp_path, reference=pe.Reference(-1.4, 0.3), models=models)
    names = [each.name for each in found.rig]
    assert names == ["camera0", "velodyne_top", "velodyne_rear"]
    assert found.to_choose == ("camera0",), "never dropped, to be chosen"
    gone = "left out: 1 gnss sensor (gnss_link)"
    assert found.lines[0] == f"{gone}; an export to Autoware sensor kit has them again"
    top = found.rig["velodyne_top"].pose
    up = rotation_matrix(-0.001, 0.015, -0.0364)[:, 2]  # the kit's, 37.7 mm along it
    assert top.position == pytest.approx(tuple(np.array([-0.5, 0.0, 2.0]) + 0.0377 * up))


def test_a_robot_s_joints_are_followed_to_its_root(tmp_path):
    """A mast that is turned to the left carries a camera: forward of it is our left."""
    robot = """<robot name="r"><link name="base"/><link name="mast"/><link name="cam_link"/>
      <link name="cam_optical_frame"/>
      <joint name="a" type="fixed"><parent link="base"/><child link="mast"/>
        <origin xyz="1 0 2" rpy="0 0 1.5707963267948966"/></joint>
      <joint name="b" type="fixed"><parent link="mast"/><child link="cam_link"/>
        <origin xyz="0.5 0 0"/></joint>
      <joint name="c" type="fixed"><parent link="cam_link"/><child link="cam_optical_frame"/>
        <origin rpy="-1.5707963 0 -1.5707963"/></joint></robot>"""
    (tmp_path / "r.urdf").write_text(robot)
    (camera,) = pt.import_rig(tmp_path / "r.urdf").rig
    assert (camera.name, camera.kind) == ("cam_link", "camera")
    assert camera.pose.position == pytest.approx((1.0, 0.5, 2.0))
    assert camera.pose.rotation_deg == pytest.approx((0, 0, 90))


def test_quaternions_of_all_rotations_come_back():
    rng = np.random.default_rng(5)
    for rpy in [*rng.uniform(-math.pi, math.pi, (200, 3)), (math.pi, 0, 0), (0, 0, math.pi)]:
        rotation = rotation_matrix(*rpy)
        again = from_quaternion("test", "q", quaternion(rotation))
        assert np.abs(again - rotation).max() < 1e-12 and quaternion(rotation)[0] >= 0.0
        longer = from_quaternion("test", "q", [1.3 * q for q in quaternion(rotation)])
        assert np.abs(longer - rotation).max() < 1e-12


# --- the reference --------------------------------------------------------------------------------


def box(low, high):
    from tests.engine import shapes

    return shapes.box(low, high)


@pytest.mark.parametrize(
    ("names", "known"),
    [
        (("body", "wheel_front_left", "wheel_rear_left"), True),
        (("body", "Tire.FL", "Tire.RL"), True),
        (("body", "steering_wheel", "wheel_arch"), False),
    ],
)
def test_the_rear_axle_is_guessed_from_wheels_alone(names, known):
    parts = [((-2.3, -1, 0.2), (2.4, 1, 1.5)), ((1.2, 0.7, 0), (1.8, 0.9, 0.6))]
    parts.append(((-1.6, 0.7, 0), (-1.0, 0.9, 0.6)))
    meshes = [box(*each) for each in parts]
    numbers = np.repeat(np.arange(3), [len(mesh) for mesh in meshes])
    vehicle = pe.Vehicle(np.concatenate(meshes), numbers, names)
    found = pe.guessed_reference(vehicle)
    assert found == (pe.Reference(-1.3, 0.3, 2.8, 0.9, 1.0) if known else None)
    assert pe.guessed_reference(None) is None


# --- what is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", [n for n, row in RIG_FORMATS.items() if row.origin.startswith("rear")]
)
def test_without_the_rear_axle_its_formats_are_refused(name, tmp_path):
    with pytest.raises(pe.InputError, match="rear axle's place, which is the origin"):
        pt.export_rig(MIXED, name, tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_nothing_is_replaced_without_being_asked(tmp_path):
    pt.export_rig(MIXED, "csv", tmp_path / "rig.csv")
    old = (tmp_path / "rig.csv").read_bytes()
    with pytest.raises(pe.InputError, match=r"rig\.csv: file: .*an existing file"):
        pt.export_rig(ONE_WAY, "csv", tmp_path / "rig.csv")
    assert (tmp_path / "rig.csv").read_bytes() == old
    pt.export_rig(ONE_WAY, "csv", tmp_path / "rig.csv", replace=True)
    assert (tmp_path / "rig.csv").read_bytes() != old


DEVICES = ("CON", "nul", "com1", "Aux", "lpt9/x")


@pytest.mark.parametrize("format_name", ["ros", "autoware"])
def test_no_file_has_a_name_that_windows_keeps_for_itself(tmp_path, format_name):
    rig = pe.Rig([sensor(name, "KITTI cam2", (0, 0, 2)) for name in DEVICES])
    paths, _ = pt.export_rig(rig, format_name, tmp_path / "rig", AXLE)
    names = [name for path in paths for name in path.relative_to(tmp_path).parts]
    assert len(paths) > len(DEVICES) and not [*filter(is_reserved, names)]
    assert len(pt.import_rig(tmp_path / "rig", format_name, AXLE).rig) == len(DEVICES)


@pytest.mark.parametrize("name", FORMULAS)
def test_a_table_is_read_back_whatever_the_names(tmp_path, name):
    rig = pe.Rig([sensor(name.replace("\t", ""), PUCK, (0, 0, 2))])
    pt.export_rig(rig, "csv", tmp_path / "rig.csv")
    with (tmp_path / "rig.csv").open(encoding="utf-8") as file:
        cells = [cell for row in csv.reader(file) for cell in row if not cell.startswith("#")]
    assert not [cell for cell in cells if marked(cell) != cell and cell[0] != "'"]
    assert [each.name for each in pt.import_rig(tmp_path / "rig.csv").rig] == [
        each.name for each in rig
    ]


JOINT = '<joint name="{0}{1}" type="fixed"><parent link="{0}"/><child link="{1}"/></joint>'
LINKS = '<link name="a"/><link name="b"/><link name="c"/>'
CALL = "static_transform_publisher --x one --frame-id a --child-frame-id b"
LEFT_HANDED = "R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: 0 1 0 0 1 0 0 0 0 0 1 0\n"


def robot(*joints):
    return "rig.urdf", f"<robot>{LINKS}{''.join(JOINT.format(*each) for each in joints)}</robot>"


BAD = [
    ("link", robot("ab")),
    ("link c", robot("bc", "cb")),
    ("link c", robot("ac", "bc")),
    ("joint 'az', child", robot("az")),
    ("file", ("rig.urdf", "<sdf/>")),
    ("y_m", ("rig.csv", "name,x_m\na,1\n")),
    ("row 1, z_m", ("rig.csv", "name,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\na,1,2,x,0,0,0\n")),
    ("objects", ("objects.json", '{"objects": []}')),
    ("file", ("objects.json", '{"objects": [')),
    ("rig.sensors", ("rig.json", '{"rig": {"sensors": [{"name": "can"}]}}')),
    ("file", ("rig.launch.xml", "<launch/>")),
    ("transform 1, x", ("rig.launch.xml", CALL)),
    ("Tr_velo_to_cam", ("calib.txt", "P0: 1 2 3\nR0_rect: 1 0 0 0 1 0 0 0 1\n")),
    ("Tr_velo_to_cam", ("calib.txt", LEFT_HANDED)),
    ("format", ("something.bin", "")),
]
ALL_SIX = "".join(f"    {key}: 0\n" for key in ("x", "y", "z", "roll", "pitch", "yaw"))
BAD_KITS = [
    ("base_link", "base_link: [1, 2]\n"),
    ("line 3", "base_link:\n    a:\n  b:\n"),
    ("base_link.a", "base_link:\n  a: &x 1\n"),
    ("line 3", "base_link:\n  a: 1\n  a: 2\n"),
    ("base_link.sensor_kit_base_link.y", "base_link:\n  sensor_kit_base_link:\n    x: 1\n"),
    ("base_link", f"base_link:\n  other:\n{ALL_SIX}"),
    ("base_link", "map:\n  x: 1\n"),
]


def test_bad_files_are_refused_by_what_is_wrong_in_them(tmp_path):
    kit = "sensors_calibration.yaml"
    (tmp_path / "sensor_kit_calibration.yaml").write_text("sensor_kit_base_link:\n")

    def imported(given):
        (tmp_path / given[0]).write_text(given[1])
        pt.import_rig(tmp_path / given[0], reference=AXLE)

    assert wrongly_refused(imported, BAD, tmp_path) == []
    assert wrongly_refused(lambda text: imported((kit, text)), BAD_KITS, tmp_path / kit) == []


def test_kitti_has_no_room_for_cameras_that_look_about():
    with pytest.raises(pe.InputError, match="one LiDAR and 1 to 4 cameras"):
        rig_files(MIXED, "kitti")
    apart = pe.Rig([*ONE_WAY, sensor("back", "KITTI cam2", (0, 0, 2), (0, 0, 180))])
    with pytest.raises(pe.InputError, match="a camera that looks as 'c0' does"):
        rig_files(apart, "kitti")


# --- the command ----------------------------------------------------------------------------------


def test_the_command_writes_and_reads(tmp_path, capsys, monkeypatch):
    from pe_tools.cli.verbs import main

    monkeypatch.chdir(tmp_path)
    pe.save_study(pe.Study(MIXED, reference=AXLE), Path("study.toml"))
    assert main(["export", "study.toml", "--to", "autoware", "-o", "kit"]) == 0
    said = capsys.readouterr()
    assert "sensor_kit_calibration.yaml" in said.out and "Pandar64" in said.err
    assert main(["import", "kit", "-o", "back.toml"]) == 1, "where the rear axle is was not said"
    command = ["import", "kit", "-o", "back.toml", "--rear-axle", "-1.31", "0.33"]
    assert main([*command, "--model", f"side_left={PUCK}"]) == 0
    told = capsys.readouterr().err
    assert "side_left: 37.7 mm from its frame up to the centre of its scan" in told
    assert "no model" not in told, "comments have them"
    back = pe.load_study("back.toml")
    assert back.samples == FIRST_SAMPLES
    assert back.reference == AXLE and len(back.rig) == len(MIXED)
    assert main(command) == 1, "a study is there"
    assert "an existing file" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("output", "chosen", "written"),
    [
        ("prius.urdf", None, "urdf"),
        ("PRIUS.URDF", None, "urdf"),
        ("objects.json", None, "carla"),
        ("scene.glb", None, "gltf"),
        ("prius.urdf", "urdf", "urdf"),
        ("rig", "ros", None),
        ("rig.launch.xml", "ros", "ros"),
        ("front.json", "osi", "osi"),
        ("kit", "autoware", "autoware"),
        ("prius.v2", "csv", "csv"),
        ("prius.urdf", "csv", None),
        ("plan.svg", "gltf", None),
        ("rig.json", None, "driveworks"),
        ("rig.json", "carla", "carla"),
        ("front.json", None, None),
        ("prius.step", None, None),
        ("prius", None, None),
    ],
)
def test_the_suffix_of_a_file_decides_its_format(output, chosen, written):
    if written is None:
        with pytest.raises(pe.InputError, match=f"{output}: format: "):
            format_of_file(Path(output), FILE_NAMES, chosen)
    else:
        assert format_of_file(Path(output), FILE_NAMES, chosen) == written
