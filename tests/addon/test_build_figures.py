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


def test_limits_and_options_of_the_panel_are_those_of_the_study(roof, car):
    settings, own = car.perception_entropy, roof.perception_entropy
    settings.max_mass, settings.min_overlap = 2.5, 20.0
    row = own.options.add()
    row.model, row.price, row.power = "Hesai Pandar64", 600.0, 22.0
    study = scenes.study()
    constraints = study.search.mounting.constraints
    assert (constraints.max_mass, constraints.min_overlap) == (2.5, 20.0)
    assert constraints.max_power is None and constraints.max_protrusion is None
    (choice,) = study.selection.choices
    assert choice.options[0].sheet == pe.DataSheet(power=22.0, price=600.0)
    own.price = 99.5
    assert scenes.study().rig["roof"].sheet.price == 99.5
