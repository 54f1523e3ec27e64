"""What can be built, in Blender: the panel, an exported study and a job say the same figures."""

import bpy
import pytest

import pe_core as pe
import pe_tools as pt
from blender_addon import live
from blender_addon.panels import search_panels
from tests.addon import layouts, scenes


@pytest.fixture
def roof(car):
    settings = car.perception_entropy
    settings.search_samples = settings.score_samples = 1024
    scenes.add_sensor("eye", "Camera 60 deg", location=(1.0, 0.0, 1.6))
    return car.objects["roof"]


def test_the_panel_and_a_job_of_the_exported_study_say_the_same(roof, car, tmp_path):
    bpy.data.objects["eye"].perception_entropy.mass = 0.4
    assert bpy.ops.pe.score() == {"FINISHED"}
    assert bpy.ops.pe.export_study(filepath=str(tmp_path / "study.toml")) == {"FINISHED"}
    study = pe.load_study(tmp_path / "study.toml")
    assert study.rig["eye"].sheet == pe.DataSheet(mass=0.4)
    job = pt.ScoreJob(study)
    list(job)
    figures = job.outcome.figures[-1]
    assert figures.built["mass"] == pytest.approx(0.83 + 0.4) and "power" in figures.unknown
    lines = pt.advice.built_lines([figures])
    assert live.built_lines(car) == lines
    panel = layouts.drawn(search_panels.constraints, **vars(layouts.Window(car)))
    assert "mass 1.23 kg" in " ".join(panel.texts("label"))
