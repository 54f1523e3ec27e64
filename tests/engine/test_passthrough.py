"""Out of what came in comes what came in: kinds that are not known here, comments, entries."""

import json
import math

import pytest

import pe_core as pe
from pe_core.study import passthrough_of_text, passthrough_text
from pe_tools.cli.verbs import main
from pe_tools.exchange import RIG_FORMATS, import_rig

AXLE = pe.Reference(-1.38, 0.3)
OPTION = ["--rear-axle", "-1.38", "0.3"]

# --- files of the form that their programs write ------------------------------------------------

CARLA = {
    "objects": [
        {"type": "sensor.pseudo.traffic_lights", "id": "traffic_lights"},
        {
            "type": "vehicle.tesla.model3",
            "id": "ego_vehicle",
            "sensors": [
                {
                    "type": "sensor.camera.rgb",
                    "id": "rgb_front",
                    "spawn_point": {
                        "x": 2.0,
                        "y": 0.1,
                        "z": 2.0,
                        "roll": 0.0,
                        "pitch": 0.3,
                        "yaw": 0.0,
                    },
                    "image_size_x": 800,
                    "image_size_y": 600,
                    "fov": 90.0,
                    "sensor_tick": 0.05,
                },
                {
                    "type": "sensor.other.radar",
                    "id": "radar_front",
                    "spawn_point": {"x": 2.0, "y": 0.0, "z": 1.5},
                    "horizontal_fov": 30.0,
                    "range": 100.0,
                },
                {
                    "type": "sensor.lidar.ray_cast",
                    "id": "lidar",
                    "spawn_point": {"x": 0.0, "y": 0.0, "z": 2.4, "yaw": 30.0},
                    "range": 50,
                    "channels": 32,
                    "points_per_second": 320000,
                    "upper_fov": 2.0,
                    "lower_fov": -26.8,
                    "rotation_frequency": 20,
                    "horizontal_fov": 120.0,
                    "noise_stddev": 0.0,
                },
                {
                    "type": "sensor.other.collision",
                    "id": "collision",
                    "spawn_point": {"x": 0.0, "y": 0.0, "z": 0.0},
                },
                {
                    "type": "sensor.other.lane_invasion",
                    "id": "lane_invasion",
                    "spawn_point": {"x": 0.0, "y": 0.0, "z": 0.0},
                },
                {"type": "sensor.pseudo.tf", "id": "tf"},
            ],
        },
    ]
}
"""As the ROS bridge's carla_spawn_objects has it (carla-simulator/ros-bridge)."""
RIG_JSON = {
    "rig": {
        "sensors": [
            {
                "name": "radar:front",
                "protocol": "radar.socket",
                "parameter": "ip=1.2.3.4",
                "nominalSensor2Rig_FLU": {"roll-pitch-yaw": [0.0, 0.0, 0.1], "t": [3.7, 0.0, 0.4]},
                "properties": {"fov": "60"},
            },
            {
                "name": "lidar:top",
                "protocol": "lidar.socket",
                "parameter": "device=LUMINAR,port=2368",
                "nominalSensor2Rig_FLU": {"roll-pitch-yaw": [0.3, -0.1, 0.7], "t": [1.1, 0.0, 1.9]},
                "properties": None,
            },
            {
                "name": "ultrasonic:left",
                "protocol": "ultrasonic.can",
                "nominalSensor2Rig_FLU": {"roll-pitch-yaw": [0.0, 0.0, 90.0], "t": [0.0, 1.0, 0.5]},
            },
            {
                "name": "camera:front",
                "protocol": "camera.gmsl",
                "parameter": "camera-name=AR0820,interface=csi-a",
                "nominalSensor2Rig_FLU": {"roll-pitch-yaw": [0.0, 1.7, 0.0], "t": [1.8, 0.0, 1.4]},
                "properties": {
                    "Model": "ftheta",
                    "cx": "1920.5",
                    "cy": "1083.1",
                    "width": "3840",
                    "height": "2168",
                    "bw-poly": "0.0 0.000534 -1.1e-9 0.0 0.0",
                    "car-mask": "rle16 0 0 3840",
                },
            },
            {"name": "vehicle:can", "protocol": "can.socket", "parameter": "device=can0"},
        ],
        "vehicle": {"valid": True, "value": {"body": {"length": 4.87}}},
    },
    "version": 7,
}
SCENE = {
    "sensor.json": [
        {"token": f"s{k}", "channel": name, "modality": kind}
        for k, (name, kind) in enumerate(
            [("RADAR_FRONT", "radar"), ("LIDAR_TOP", "lidar"), ("RADAR_BACK", "radar")]
        )
    ],
    "calibrated_sensor.json": [
        {
            "token": f"c{k}",
            "sensor_token": f"s{k}",
            "translation": [3.412 - k, 0.01, 0.5 + k],
            "rotation": [0.9999984769132877, 0.0, 0.0, 0.0017453283658983088],
            "camera_intrinsic": [],
        }
        for k in range(3)
    ],
}
CSV = (
    "name,kind,model,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
    "roof,lidar,Velodyne VLP-16 Puck,0.1,0,1.9,0,0,0\n"
    "corner,radar,Continental ARS408-21,2.1,0.7,0.5,0,0,45\n"
    "beam,sonar,S1,2.1,0.7,0.4,0,0,45\n"
)
KIT = """# A kit, as tier4's aip_xx1_gen2 has it.
sensor_kit_base_link:
  camera0/camera_link:
    x: 0.372 # Design Value
    y: 0.0 # Design Value
    z: -0.207
    roll: -0.00
    pitch: 0.0
    yaw: 0.0

  hesai_top_base_link:   # the one on the roof
    x: 0.0
    y: 0.0
    z: 0.0
    roll: 0.0
    pitch: 0.0
    yaw: 4.36332298038 # Design Value
  hesai_left_base_link:
    x: 0.0
    y: 0.564
    z: -0.300
    roll: 0.872665
    pitch: 0.0
    yaw: 3.14159265359
  gnss_link: # behind
    x: -0.279
    y: 0.0
    z: -0.160
    roll: 0.0
    pitch: 0.0
    yaw: 0.0
"""
ON_BASE = """base_link:
  sensor_kit_base_link:
    x: 0.9 # Design Value
    y: 0.0
    z: 2.0
    roll: -0.001
    pitch: 0.015
    yaw: -0.0364
  front_center/radar_link:
    x: 3.7
    y: 0.0
    z: 0.5
    roll: 0.0
    pitch: 0.0
    yaw: 0.0
  rear_left/radar_link:
    x: -1.0
    y: 0.7
    z: 0.5
    roll: 0.0
    pitch: 0.0
    yaw: 2.4
"""
FILES = {
    "carla": {"objects.json": json.dumps(CARLA)},
    "driveworks": {"rig.json": json.dumps(RIG_JSON)},
    "nuscenes": {name: json.dumps(rows) for name, rows in SCENE.items()},
    "csv": {"rig.csv": CSV},
    "autoware": {"sensors_calibration.yaml": ON_BASE, "sensor_kit_calibration.yaml": KIT},
}
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
    pe.export_rig(rig, name, out, AXLE, passthrough=found.passthrough)
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
        _, lines = pe.export_rig(rig, "autoware", kit, AXLE, replace=True)
    assert data_of(kit) == before, "and no camera_info"
    assert "camera0: the kit has no camera_info of it; its lens is not written" in lines
    new = tmp_path / "new"
    pe.export_rig(rig, "autoware", new, AXLE)
    again = import_rig(new, None, AXLE).rig
    for name in ("hesai_top", "hesai_left"):
        assert again[name].pose.position == pytest.approx(rig[name].pose.position, abs=1e-9)


def test_a_comment_that_names_a_model_is_one_and_stays_true(tmp_path):
    """Kits that are written say so; a comment of the maker's is none, and stays."""
    kit = written(tmp_path / "kit", "autoware")
    file = kit / "sensor_kit_calibration.yaml"
    file.write_text(KIT.replace("the one on the roof", "Hesai QT128C2X"))
    found = import_rig(kit, None, AXLE)
    assert found.rig["hesai_top"].model.name == "Hesai QT128C2X"
    assert "hesai_top" not in found.to_choose and "hesai_left" in found.to_choose
    for model in ("Hesai OT128 (Pandar128E4X)", "Velodyne VLP-16 Puck"):
        top = pe.Sensor("hesai_top", pe.catalog.load(model), found.rig["hesai_top"].pose)
        pe.export_rig(pe.Rig([top]), "autoware", kit, AXLE, replace=True)
        assert f"  hesai_top_base_link:   # {model}\n" in file.read_text()
    own = pe.Sensor("hesai_top", pe.Lidar("own", [0.0], 36, 30.0), top.pose)
    pe.export_rig(pe.Rig([own]), "autoware", kit, AXLE, replace=True)
    assert "  hesai_top_base_link:\n" in file.read_text()


def test_a_lens_of_a_kit_is_written_when_it_is_another(tmp_path):
    kit = written(tmp_path / "kit", "autoware")
    info = (
        "# calibrated in March\nimage_width: 800\nimage_height: 400\ncamera_matrix:\n"
        "  data: [526.2, 0, 401.0, 0, 526.2, 199.0, 0, 0, 1]\n"
        "distortion_coefficients:\n  data: [0.01, 0, 0, 0, 0]\n"
    )
    (kit / "camera_info").mkdir()
    file = kit / "camera_info" / "camera0.yaml"
    file.write_text(info)
    rig = import_rig(kit, None, AXLE).rig
    pe.export_rig(rig, "autoware", kit, AXLE, replace=True)
    assert file.read_text() == info
    other = pe.Sensor("camera0", pe.catalog.load("KITTI cam2"), rig["camera0"].pose)
    pe.export_rig(pe.Rig([other]), "autoware", kit, AXLE, replace=True)
    assert "image_width: 1242" in file.read_text()


def test_a_model_that_was_chosen_is_written_and_one_that_stands_in_is_not(tmp_path):
    path = written(tmp_path / "in", "driveworks")
    chosen = {"lidar:top": "Hesai OT128 (Pandar128E4X)"}
    for models, word in ((chosen, "model=Hesai OT128 (Pandar128E4X)"), ({}, "device=LUMINAR")):
        found = import_rig(path, None, AXLE, models)
        out = tmp_path / word[:5] / "rig.json"
        pe.export_rig(found.rig, "driveworks", out, AXLE, passthrough=found.passthrough)
        row = json.loads(out.read_text())["rig"]["sensors"][1]
        assert row["name"] == "lidar:top" and row["parameter"].startswith(word)


def test_the_file_s_own_place_is_taken_back(tmp_path):
    """A file whose origin was put somewhere goes out from there, its radar where it was."""
    path = written(tmp_path / "in", "carla")
    placed = pe.Pose((0.4, 0.1, -0.2), (0.0, 0.1, 0.3))
    found = import_rig(path, None, None, None, placed)
    assert found.rig["lidar"].pose.position != (0.0, 0.0, 2.4)
    pe.export_rig(found.rig, "carla", tmp_path / "objects.json", passthrough=found.passthrough)
    assert json.loads((tmp_path / "objects.json").read_text()) == CARLA


def test_carla_s_horizontal_fov_is_the_lidar_s(tmp_path):
    """320,000 points a second, 20 turns, 32 channels: 500 steps in 120 degrees, both edges on."""
    lidar = import_rig(written(tmp_path / "in", "carla")).rig["lidar"].model
    assert math.degrees(lidar.horizontal_fov[1]) == pytest.approx(60.0)
    assert lidar.beam_count == 501 * 32
    rig = pe.Rig([pe.Sensor("lidar", lidar, pe.Pose((0, 0, 2)))])
    pe.export_rig(rig, "carla", tmp_path / "objects.json")
    (row,) = json.loads((tmp_path / "objects.json").read_text())["objects"][0]["sensors"]
    assert row["horizontal_fov"] == pytest.approx(120.0)
    assert row["points_per_second"] / 10 == 501 * 32


def test_other_formats_have_no_part_in_it(tmp_path):
    found = import_rig(written(tmp_path / "in", "nuscenes"), None, AXLE)
    _, lines = pe.export_rig(
        found.rig, "driveworks", tmp_path / "rig.json", AXLE, passthrough=found.passthrough
    )
    rows = json.loads((tmp_path / "rig.json").read_text())["rig"]["sensors"]
    assert rows[1]["name"] == "LIDAR_TOP" and not any("came in" in line for line in lines)


def test_osi_s_radars_keep_their_ids_and_all_else(tmp_path):
    """Cameras are numbered round them; three times."""
    radar = {"sensorId": {"value": "0"}, "emitterFrequency": 77e9}
    camera = {"sensorId": {"value": "3"}, "mountingPosition": {"position": {"x": 2.5, "z": 1.0}}}
    data = {
        "radarSensorViewConfiguration": [radar],
        "ultrasonicSensorViewConfiguration": [{"sensor_id": {"value": 7}}],
        "cameraSensorViewConfiguration": [camera],
    }
    path = tmp_path / "0.json"
    path.write_text(json.dumps(data))
    for number in (1, 2, 3):
        found = import_rig(path, "osi", AXLE)
        assert not any("left out" in line for line in found.lines)
        assert {s.kind for s in found.rig} == {"camera", "radar", "ultrasonic"}
        path = tmp_path / f"{number}.json"
        pe.export_rig(found.rig, "osi", path, AXLE, passthrough=found.passthrough)
        out = json.loads(path.read_text())
        (ours,) = out["radar_sensor_view_configuration"]
        assert ours == {"sensor_id": {"value": "0"}, "emitter_frequency": 77e9}
        assert out["ultrasonic_sensor_view_configuration"] == [{"sensor_id": {"value": 7}}]
        (eye,) = out["camera_sensor_view_configuration"]
        assert eye["sensor_id"] == {"value": 1}
        assert eye["mounting_position"]["position"] == pytest.approx({"x": 2.5, "y": 0, "z": 1})


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
