"""One scene, one result: the panel, headless Blender and `pe` on the exported study, to the bit.

Conditions are in `test_poses_of_states`, requirements in `test_presets_everywhere`.
"""

import json

import bpy
import pytest

from blender_addon.caches import result_staleness
from blender_addon.live import session
from blender_addon.processes import engine_calls
from tests.addon import scenes
from tests.addon.command_line import pe_here, run_here

LABELS = "class,x,y,z,length,width,height,yaw\ncar,20,3,0.8,4,2,1.6,30\n"
OF_A_FRONT_END = ("run", "inputs")


def focus_on_boxes(settings, folder):
    (folder / "labels.csv").write_text(LABELS)
    settings.prior = "boxes"
    settings.boxes = str(folder / "labels.csv")
    bpy.ops.pe.add_row(rows="focus", kind="far")
    bpy.ops.pe.add_row(rows="focus", kind="custom")
    settings.focus[1].x_range = (0.1, 33.3)
    settings.focus[1].classes = {"car"}


def objects_in_traffic(settings, _):
    settings.targets = "objects"
    settings.traffic = True
    settings.scenes = 8


def returns_of_the_road(settings, folder):
    objects_in_traffic(settings, folder)
    settings.ap_model = "scans"
    settings.returns = "road"


def curve_of_published_camera_rigs(settings, folder):
    objects_in_traffic(settings, folder)
    scenes.add_sensor("eye", "Camera 90 deg", location=(0.9, 0.0, 1.5))
    settings.ap_model = "camera_rigs"


def curve_with_a_range_term_and_the_floor(settings, _):
    bpy.ops.pe.add_row(rows="curves")
    settings.curves["lidar"].own = True
    settings.curves["lidar"].c = 0.25


def radar_and_ultrasonic_sensor(*_):
    scenes.add_sensor("front", "Continental ARS408-21", location=(2.5, 0.0, 0.5))
    scenes.add_sensor("parking", "Parking module 2.5 m", location=(2.5, 0.4, 0.5))


def search_by_expected_ap(settings, _):
    settings.objective = "expected_ap"
    settings.scenes = 8
    settings.method = "portfolio"
    settings.evaluations = 12
    settings.seed = 4
    settings.search_samples = settings.score_samples = 1024


SCENES = {
    each.__name__: each
    for each in (
        focus_on_boxes,
        objects_in_traffic,
        returns_of_the_road,
        radar_and_ultrasonic_sensor,
        curve_of_published_camera_rigs,
        curve_with_a_range_term_and_the_floor,
        search_by_expected_ap,
    )
}


def told(result: dict) -> dict:
    """A result without what differs from run to run and from file to file."""
    kept = {key: value for key, value in result.items() if key not in OF_A_FRONT_END}
    for score in (kept["before"], kept["after"]):
        score.pop("figures", None)  # beside it in result.json
        score.pop("scatter", None)  # for the error of a difference: no part of result.json
    return kept


def output_of(verb, folder):
    """The options with which a verb writes into a folder; a score needs none."""
    return ["--no-review", "-o", folder] if verb == "optimize" else []


@pytest.mark.parametrize("name", SCENES)
def test_panel_headless_and_pe_find_the_same_bits(car, tmp_path, name):
    settings = car.perception_entropy
    verb = "optimize" if "search" in name else "score"
    before = result_staleness.fingerprint(car).text
    SCENES[name](settings, tmp_path)
    bpy.context.view_layer.update()
    assert result_staleness.fingerprint(car).text != before, "a stored score of before is stale"
    (tmp_path / "study").mkdir()
    study = tmp_path / "study" / "study.toml"
    blend = tmp_path / "car.blend"
    assert bpy.ops.pe.export_file(filepath=str(study)) == {"FINISHED"}
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    assert getattr(bpy.ops.pe, verb)() == {"FINISHED"}
    panel = told(json.loads(settings.result_json))
    headless = run_here(blend, [verb, *output_of(verb, tmp_path / "headless"), "--json"])
    alone = pe_here([verb, study, *output_of(verb, tmp_path / "alone"), "--json"])
    for answer in (headless, alone):
        assert answer.returncode == 0, answer.stderr
        assert told(json.loads(answer.stdout)) == panel


def test_a_live_score_is_of_the_same_targets(car):
    objects_in_traffic(car.perception_entropy, None)
    wish = session.read_request(car, scenes.depsgraph())
    summary, _ = engine_calls.live_score("scene", wish, None)
    study = scenes.study()
    assert summary.entropy == study.evaluator().entropy(study.rig) and summary.voxels == 0
