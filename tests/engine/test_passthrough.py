"""Out of what came in comes what came in: kinds that are not known here, comments, entries."""

import json
from pathlib import Path

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.study import passthrough_of_text, passthrough_text
from pe_tools.cli.verbs import main
from pe_tools.exchange import RIG_FORMATS, import_rig

AXLE = pe.Reference(-1.38, 0.3)
OPTION = ["--rear-axle", "-1.38", "0.3"]

FOREIGN = Path(__file__).parent / "foreign"
"""Files as their programs write them, a folder a format: carla_spawn_objects of CARLA's ROS bridge,
a rig.json of DriveWorks, tables of nuScenes, a CSV, a kit of the form of tier4's aip_xx1_gen2."""
FILES = {
    folder.name: {file.name: file.read_text("utf-8") for file in sorted(folder.iterdir())}
    for folder in sorted(FOREIGN.iterdir())
}
CARLA = json.loads(FILES["carla"]["objects.json"])
LEFT_OUT = {
    "carla": "1 collision sensor (collision), "
    "1 lane_invasion sensor (lane_invasion), 1 pseudo sensor (tf)",
    "driveworks": "1 can sensor (vehicle:can)",
    "nuscenes": "",
    "csv": "1 sonar sensor (beam)",
    "autoware": "1 gnss sensor (gnss_link)",
}
RIG = {
    "carla": {"rgb_front": "camera", "radar_front": "radar", "lidar": "lidar"},
    "driveworks": {
        **{"radar:front": "radar", "lidar:top": "lidar", "ultrasonic:left": "ultrasonic"},
        "camera:front": "camera",
    },
    "nuscenes": {"RADAR_FRONT": "radar", "LIDAR_TOP": "lidar", "RADAR_BACK": "radar"},
    "csv": {"roof": "lidar", "corner": "radar"},
    "autoware": {
        **{"camera0": "camera", "hesai_top": "lidar", "hesai_left": "lidar"},
        **{"front_center": "radar", "rear_left": "radar"},
    },
}


def written(folder, name):
    """The files of a format in a folder, and what is read: the folder, or the one file."""
    folder.mkdir()
    for file, text in FILES[name].items():
        (folder / file).write_text(text)
    return folder if len(FILES[name]) > 1 else folder / next(iter(FILES[name]))


def data_of(path):
    """All files below a path: JSON as data, other text as it is."""
    files = sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]
    return {
        each.name: json.loads(each.read_text()) if each.suffix == ".json" else each.read_text()
        for each in files
    }


@pytest.mark.parametrize("name", FILES)
def test_a_file_goes_through_studies_three_times_and_is_what_it_was(name, tmp_path, capsys):
    """By the command, each time into a new place: no number, name or comment is another."""
    path = written(tmp_path / "0", name)
    before = data_of(path)
    for number in (1, 2, 3):
        study, out = tmp_path / f"{number}.toml", tmp_path / str(number) / path.name
        capsys.readouterr()
        assert main(["import", str(path), "--from", name, "-o", str(study), *OPTION]) == 0
        told = capsys.readouterr().err
        title = RIG_FORMATS[name].title
        left = f"left out: {LEFT_OUT[name]}; an export to {title} has them again\n"
        assert left in told if LEFT_OUT[name] else "left out" not in told
        assert {s.name: s.kind for s in pe.load_study(study).rig} == RIG[name]
        assert main(["export", str(study), "--to", name, "-o", str(out)]) == 0
        told = capsys.readouterr().err
        left = f"as they came in: {LEFT_OUT[name]}\n"
        assert left in told if LEFT_OUT[name] else "came in" not in told
        path = out
    if name == "csv":  # a table gets its head and its empty columns
        rows = [line for line in data_of(path)["rig.csv"].splitlines() if line[0] != "#"]
        assert rows[1].startswith("roof,lidar,Velodyne VLP-16 Puck,0.1,0.0,1.9,")
        assert rows[2].startswith("corner,radar,Continental ARS408-21,2.1,0.7,0.5,0.0,0.0,45.0,")
        assert rows[3].startswith("beam,sonar,S1,2.1,0.7,0.4,0,0,45,")
        return
    assert data_of(path) == before


@pytest.mark.parametrize("name", ["carla", "driveworks", "nuscenes", "autoware"])
def test_what_moved_moves_and_nothing_else_changes(name, tmp_path):
    path = written(tmp_path / "in", name)
    found = import_rig(path, name, AXLE)
    moved = next(iter(found.rig))
    pose = pe.Pose((moved.pose.position[0] + 0.25, *moved.pose.position[1:]), moved.pose.rpy)
    rig = pe.Rig([moved.moved(pose), *list(found.rig)[1:]])
    out = tmp_path / "out" / path.name
    pt.export_rig(rig, name, out, AXLE, passthrough=found.passthrough)
    before, after = data_of(path), data_of(out)
    again = import_rig(out, name, AXLE).rig
    for ours, theirs in zip(rig, again, strict=True):
        assert theirs.pose.position == pytest.approx(ours.pose.position, abs=1e-9)
    changed = [file for file in before if before[file] != after[file]]
    assert len(changed) == 1 and set(before) == set(after)
    texts = [json.dumps(d, indent=0).splitlines() if not isinstance(d, str) else d.splitlines()
             for d in (before[changed[0]], after[changed[0]])]  # fmt: skip
    lines = [pair for pair in zip(*texts, strict=True) if pair[0] != pair[1]]
    assert 1 <= len(lines) <= (3 if name == "autoware" else 7), "a place, perhaps its angles"
    if name == "autoware":  # the kit is turned: x, y and z by hand
        numbers = [float(new.split()[1]) for _, new in lines]
        turn = pe.Pose((0, 0, 0), (-0.001, 0.015, -0.0364)).ground_from_sensor
        by_hand = [a + 0.25 * b for a, b in zip((0.372, 0.0, -0.207), turn[0], strict=True)]
        assert numbers == pytest.approx(by_hand)
        assert lines[0][1].endswith(" # Design Value")


def test_a_kit_that_is_there_keeps_its_text_without_the_study_s_help(tmp_path):
    """A rig alone, three times: LiDARs whose model stands in are lifted and let down alike."""
    kit = written(tmp_path / "kit", "autoware")
    before = data_of(kit)
    for _ in range(3):
        rig = import_rig(kit, None, AXLE).rig
        _, lines = pt.export_rig(rig, "autoware", kit, AXLE, replace=True)
    assert data_of(kit) == before, "and no camera_info"
    assert "camera0: the kit has no camera_info of it; its lens is not written" in lines
    new = tmp_path / "new"
    pt.export_rig(rig, "autoware", new, AXLE)
    again = import_rig(new, None, AXLE).rig
    for name in ("hesai_top", "hesai_left"):
        assert again[name].pose.position == pytest.approx(rig[name].pose.position, abs=1e-9)


def test_it_is_a_text_and_back_and_says_what_is_wrong(tmp_path):
    for name in FILES:
        kept = import_rig(written(tmp_path / name, name), name, AXLE).passthrough
        assert passthrough_of_text(passthrough_text(kept), "scene") == kept
    assert passthrough_of_text("", "scene") is None and passthrough_text(None) == ""
    row = {"name": "a", "kind": "radar"}
    for table, words in [
        ({"format": "carla", "sensor": [row | {"entry": "[]"}]}, "entry: expected a JSON object"),
        ({"format": "carla", "sensor": [row | {"pose": [1, 2]}]}, "a list of 6 numbers"),
        ({"format": "carla", "files": {"../up": ""}}, "the name of a file"),
        ({"format": "carla", "files": {"a": 3}}, "a text"),
        ({"format": "carla", "more": 1}, "more"),
    ]:
        with pytest.raises(pe.InputError, match=words):
            passthrough_of_text(json.dumps(table), "scene")
