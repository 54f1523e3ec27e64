"""Radars for other programs: CARLA's, nebula's, and the plugin that writes for it."""

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest

import pe_core as pe
import pe_tools as pt
from pe_core import catalog
from pe_tools.formats.yaml_text import parse_yaml
from pe_tools.outputs import scene_files
from tests.engine.conftest import CHECKOUT, EXAMPLE_PLUGIN


def test_a_radar_of_carla_is_its_field_of_view(tmp_path):
    radar = {
        "type": "sensor.other.radar",
        "id": "radar_front",
        "spawn_point": {"x": 2.0, "y": 0.0, "z": 1.5},
        "horizontal_fov": 40.0,
        "range": 80.0,
    }
    path = tmp_path / "objects.json"
    path.write_text(json.dumps({"objects": [{"type": "vehicle.a", "id": "e", "sensors": [radar]}]}))
    (sensor,) = pt.import_rig(path).rig
    (mode,) = sensor.model.modes
    assert math.degrees(mode.azimuths[1]) == pytest.approx(20.0)
    assert math.degrees(mode.elevations[1]) == pytest.approx(15.0)
    assert mode.max_range == 80.0 and mode.range_resolution is None


def test_nebula_gets_positions_angles_and_the_damping_of_covers(example_plugin):
    """From the front axle; the radar's own cover and the bumper before it are 1.5 + 2 dB."""
    model = catalog.load("Continental ARS408-21")
    lossy = catalog.from_table("lossy", {**catalog.to_table(model), "cover_loss_db": 1.5})
    wall = np.array([[3.5, -2, 0], [3.5, 2, 0], [3.5, 2, 2], [3.5, -2, 2]], float)
    body = np.concatenate([wall[[[0, 1, 2], [0, 2, 3]]], wall[[[0, 1, 2], [0, 2, 3]]] - (6, 0, 0)])
    covers = {"bumper": 2.0}
    car = pe.Vehicle(body, np.array([0, 0, 1, 1]), ("bumper", "body"), covers=covers)
    front = pe.Sensor("front", lossy, pe.Pose.from_degrees((3.4, 0.1, 0.5), (0, -1, 30)))
    rear = pe.Sensor("rear", model, pe.Pose.from_degrees((-2.9, 0, 0.5), (2, 0, 180)))
    study = pe.Study(pe.Rig([front, rear]), car, reference=pe.Reference(-1.4, 0.3, 2.8))
    files, lines = scene_files(study, "nebula")
    found = parse_yaml("nebula", files["nebula_radars.yaml"].decode())
    assert found["front"] == {
        "model": "lossy", "longitudinal": 2.0, "lateral": 0.1, "vertical": 0.5,
        "yaw": pytest.approx(math.radians(30), abs=1e-6),
        "pitch": pytest.approx(math.radians(-1), abs=1e-6), "cover_damping": 3.5,
    }  # fmt: skip
    assert found["rear"]["longitudinal"] == -4.3 and found["rear"]["cover_damping"] == 0.0
    assert lines == ["rear: nebula has no roll; left out"]
    camera = pe.Sensor("eye", catalog.load("nuScenes front"), pe.Pose((0, 0, 1)))
    _, lines = scene_files(pe.Study(pe.Rig([camera])), "nebula")
    assert "no radar in the rig: the file names none" in lines


@pytest.mark.parametrize("installed", [True, False])
def test_the_example_of_a_plugin_adds_its_outputs_to_the_command(
    installed, example_plugin, tmp_path
):
    """Without it the one line names it; the status is that of bad input."""
    pe.save_study(
        pe.Study(pe.Rig([pe.Sensor("r", catalog.load("Delphi ESR"), pe.Pose((0, 0, 1)))])),
        tmp_path / "study.toml",
    )
    paths = [example_plugin, EXAMPLE_PLUGIN] if installed else []
    inherited = os.environ.get("PYTHONPATH")
    path = os.pathsep.join(map(str, [CHECKOUT, *paths, *([inherited] if inherited else [])]))
    environment = os.environ | {"PYTHONPATH": path}
    options = ["--to", "nebula", "-o", "a.yaml"]
    command = [sys.executable, "-m", "pe_core", "export", "study.toml", *options]
    answer = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert answer.returncode == (0 if installed else 1), answer.stderr
    assert (tmp_path / "a.yaml").exists() == installed
    if not installed:
        (line,) = answer.stderr.splitlines()
        assert "perception-entropy-outputs" in line and "nebula" in line
