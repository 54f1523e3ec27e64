"""An export into a file: what the rig says changes, and what else the file has stays, for each
format that has more to say than a rig."""

import json
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_tools.cli.verbs import main
from pe_tools.exchange import RIG_FORMATS, import_rig, rig_files

AXLE = pe.Reference(-1.38, 0.3)
OPTION = ["--rear-axle", "-1.38", "0.3"]
FOREIGN = Path(__file__).parent / "foreign"
"""Files as their programs write them, a folder a format: carla_spawn_objects of CARLA's ROS bridge,
a rig.json of DriveWorks, tables of nuScenes, a CSV, a kit of the form of tier4's aip_xx1_gen2, a
robot of Gazebo, static transforms, a sensor view configuration."""
FORMATS = sorted(folder.name for folder in FOREIGN.iterdir())
CARLA = json.loads((FOREIGN / "carla" / "objects.json").read_text())
LEFT_OUT = {
    "carla": ("collision", "lane_invasion", "tf"),
    "driveworks": ("vehicle:can",),
    "nuscenes": (),
    "csv": ("beam",),
    "autoware": ("gnss_link",),
    "urdf": ("ear", "imu_link"),
    "ros": ("front_sonar", "mast_frame"),
    "osi": (),
}
RIG = {
    "carla": {"rgb_front": "camera", "radar_front": "radar", "lidar": "lidar"},
    "driveworks": {
        "radar:front": "radar",
        "lidar:top": "lidar",
        "ultrasonic:left": "ultrasonic",
        "camera:front": "camera",
    },
    "nuscenes": {"RADAR_FRONT": "radar", "LIDAR_TOP": "lidar", "RADAR_BACK": "radar"},
    "csv": {"roof": "lidar", "corner": "radar"},
    "autoware": {
        "camera0": "camera",
        "hesai_top": "lidar",
        "hesai_left": "lidar",
        "front_center": "radar",
        "rear_left": "radar",
    },
    "urdf": {"roof": "lidar", "eye": "camera"},
    "ros": {"lidar_top": "lidar", "eye": "camera"},
    "osi": {"lidar_4": "lidar", "radar_7": "radar", "sensor_9": "lidar"},
}
NEW = pe.Sensor("added", pe.catalog.load("KITTI cam2"), pe.Pose((0.4, 0.1, 2.2), (0.0, 0.2, 0.3)))
STAYS = {
    "carla": ("collision", "lane_invasion"),
    "driveworks": ("device=can0", "rle16"),
    "nuscenes": ("RADAR_BACK",),
    "csv": ("# Measured by hand in May.", "beam,odd,sonar,S1,2.1,0.7,0.4,0,0,45"),
    "autoware": ("gnss_link: # behind", "# A kit, as tier4's"),
    "urdf": ("<!-- the mast is", "package://cart/body.dae", 'type="sonar"', "<!-- A cart"),
    "ros": ("base_link old", "lidar_node", "front_sonar"),
    "osi": ("version_major", "smell", "rx_antenna_diagram"),
}
"""Texts of each file that no rig has."""
SDF = """<sdf version="1.9"><model name="m"><link name="l"><sensor name="s" type="lidar"/></link>
</model></sdf>"""
POSE = pe.Pose((0.5, 0.0, 1.9), (0.0, 0.1, 0.2))


def copied(folder, name):
    """A copy of the files of a format, and what is read: the folder, or the one file."""
    folder.mkdir()
    files = sorted((FOREIGN / name).iterdir())
    for file in files:
        (folder / file.name).write_bytes(file.read_bytes())
    return folder if len(files) > 1 else folder / files[0].name


def data_of(path):
    """All files below a path: JSON as data, other text as it is."""
    files = sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]
    return {
        each.name: json.loads(each.read_text()) if each.suffix == ".json" else each.read_text()
        for each in files
    }


def lines_of(data):
    """Texts of the lines of each file."""
    texts = (d if isinstance(d, str) else json.dumps(d, indent=0) for d in data.values())
    return [line for text in texts for line in text.splitlines()]


def changed_lines(before, after):
    """The lines of before that are not after."""
    return list((Counter(lines_of(before)) - Counter(lines_of(after))).elements())


def same_pose(a, b):
    turned = np.abs(a.ground_from_sensor - b.ground_from_sensor).max()
    return np.abs(np.subtract(a.position, b.position)).max() < 1e-9 and turned < 1e-9


def test_each_format_that_merges_has_its_file():
    assert {name for name, row in RIG_FORMATS.items() if row.merges} == set(FORMATS)


@pytest.mark.parametrize("name", FORMATS)
def test_a_file_is_what_it_was_after_its_rig_went_into_it(name, tmp_path, capsys):
    """By the command, through a study: no number, name or comment is another."""
    path = copied(tmp_path / "in", name)
    before = data_of(path)
    study = tmp_path / "study.toml"
    out = tmp_path / "out" / path.name
    assert main(["import", str(path), "--from", name, "-o", str(study), *OPTION]) == 0
    told = capsys.readouterr().err
    assert all(f"{each}" in told for each in LEFT_OUT[name])
    assert ("left out: " in told) == bool(LEFT_OUT[name])
    assert {s.name: s.kind for s in pe.load_study(study).rig} == RIG[name]
    options = ["--to", name, "--into", str(path)]
    assert main(["export", str(study), *options, "-o", str(out)]) == 0
    told = capsys.readouterr().err
    assert ("kept as in the file: " in told) == bool(LEFT_OUT[name])
    assert data_of(out) == before
    assert main(["export", str(study), *options]) == 0
    assert data_of(path) == before, "in its place"


@pytest.mark.parametrize("name", FORMATS)
def test_each_sensor_moves_alone(name, tmp_path):
    """The others stay where they were, also those on the link of the one that moved."""
    path = copied(tmp_path / "in", name)
    rig = import_rig(path, name, AXLE).rig
    before = data_of(path)
    for moved in rig:
        x, y, z = moved.pose.position
        pose = pe.Pose((x + 0.25, y - 0.125, z), (0.0, *moved.pose.rpy[1:]))
        changed = pe.Rig([s.moved(pose) if s is moved else s for s in rig])
        out = tmp_path / moved.name.replace(":", "_") / path.name
        pt.export_rig(changed, name, out, AXLE, into=path)
        again = import_rig(out, name, AXLE).rig
        assert [s.name for s in again] == [s.name for s in rig]
        for ours, theirs in zip(changed, again, strict=True):
            assert same_pose(ours.pose, theirs.pose), (moved.name, ours.name)
            assert ours.kind == theirs.kind
        assert 1 <= len(changed_lines(before, data_of(out))) <= 8, "a place, perhaps its angles"


@pytest.mark.parametrize("name", FORMATS)
def test_a_sensor_is_added_another_leaves_and_a_third_is_of_another_model(name, tmp_path):
    path = copied(tmp_path / "in", name)
    before = data_of(path)
    first, second, *others = import_rig(path, name, AXLE).rig
    model = pe.catalog.load("Pandar64" if second.kind == "lidar" else "Front 120 deg 8 MP")
    if second.kind not in ("lidar", "camera"):
        model = second.model
    third = pe.Sensor(second.name, model, second.pose)
    rig = pe.Rig([third, *others, NEW])
    _, lines = pt.export_rig(rig, name, path, AXLE, replace=True)
    again = import_rig(path, name, AXLE).rig
    added = "camera_0" if name == "osi" else NEW.name  # OSI has numbers
    expected = {added, *(s.name for s in rig if s is not NEW)}
    if name in ("autoware", "ros"):  # their frames may be those of others, too
        expected |= {first.name}
    assert {s.name for s in again} == expected
    told = [line for line in lines if line.startswith("no sensors of the rig")]
    assert bool(told) == (name in ("autoware", "ros"))
    assert same_pose(again[added].pose, NEW.pose)
    if RIG_FORMATS[name].holds & {"model", "beams"} and second.kind == "lidar" and name != "osi":
        assert again[second.name].model.max_range == model.max_range
    for text in STAYS[name]:
        assert any(text in line for line in lines_of(before))
        assert any(text in line for line in lines_of(data_of(path))), text


def test_a_robot_s_sensor_on_a_link_keeps_what_gazebo_was_told_of_it(tmp_path):
    path = copied(tmp_path / "in", "urdf")
    rig = import_rig(path).rig
    model = pe.Lidar("own", np.radians([-10.0, 0.0, 10.0]), 36, 80.0)
    roof = pe.Sensor("roof", model, rig["roof"].pose, fusion="top")
    pt.export_rig(pe.Rig([roof, rig["eye"]]), "urdf", path, replace=True)
    root = ElementTree.fromstring(path.read_text())
    (lidar,) = root.findall("gazebo[@reference='roof']/sensor")
    assert lidar.findtext("update_rate") == "10" and lidar.findtext("lidar/noise") == "0.01"
    assert lidar.findtext("lidar/scan/vertical/samples") == "3"
    assert import_rig(path).rig["roof"].model.beam_count == model.beam_count


def test_a_file_of_another_content_is_replaced_as_a_whole_and_refused_as_a_target(tmp_path):
    path = tmp_path / "rig.urdf"
    path.write_text("<html/>")
    with pytest.raises(pe.InputError, match="URDF"):
        rig_files(pe.Rig([NEW]), "urdf", into=path)
    _, lines = pt.export_rig(pe.Rig([NEW]), "urdf", path, replace=True)
    assert any(line.startswith("replaced as a whole") for line in lines)
    assert [s.name for s in import_rig(path).rig] == ["added"]


@pytest.mark.parametrize(
    ("name", "file", "field"),
    [("kitti", "calib.txt", "into"), ("csv", "gone.csv", ""), ("urdf", "car.sdf", "file")],
)
def test_files_that_cannot_be_gone_into_are_refused(name, file, field, tmp_path):
    text = "" if name != "urdf" else SDF
    if file != "gone.csv":
        (tmp_path / file).write_text(text)
    with pytest.raises(pe.InputError) as caught:
        rig_files(pe.Rig([NEW]), name, AXLE, into=tmp_path / file)
    assert caught.value.field == field


def test_an_export_needs_a_place(tmp_path, capsys):
    pe.save_study(pe.Study(pe.Rig([NEW])), tmp_path / "study.toml")
    with pytest.raises(SystemExit):
        main(["export", str(tmp_path / "study.toml"), "--to", "csv"])
    assert "--into" in capsys.readouterr().err


@pytest.mark.parametrize("name", RIG_FORMATS)
def test_an_export_over_the_last_one_is_the_same(name, tmp_path):
    rig = pe.Rig([NEW, pe.Sensor("roof", pe.Lidar("own", np.radians([-9.0, 3.0]), 36, 80.0), POSE)])
    if name == "argoverse2":
        pytest.importorskip("pyarrow", reason="of the extra argoverse")
    written = []
    for _ in range(2):
        paths, _ = pt.export_rig(rig, name, tmp_path / "out", AXLE, replace=True)
        written.append([path.read_bytes() for path in paths])
    assert written[0] == written[1]
