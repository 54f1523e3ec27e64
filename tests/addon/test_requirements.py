"""Requirements in the scene: one record with the study file, verdicts of the engine to the bit."""

import json

import bpy
import numpy as np
import pytest

import pe_core as pe
from blender_addon import bridge
from blender_addon.operators import requirements as operators
from blender_addon.overlay.requirement_zones import MET, NOT_MET
from pe_core.study import requirement_file
from pe_tools import graphics
from tests.addon import scenes
from tests.addon.command_line import pe_here, run_here


@pytest.fixture
def held(car):
    """A car with a LiDAR and a camera at its front, held to a preset and two own requirements."""
    scenes.seen_rig(car)
    settings = car.perception_entropy
    settings.score_samples = 4096
    settings.requirements.clear()
    for preset in ("ncap26_reverse_static", "OWN", "OWN"):
        assert bpy.ops.pe.add_requirement(preset=preset) == {"FINISHED"}
    settings.requirements[1].x_to = "front + 2"
    settings.requirements[2].x_from, settings.requirements[2].x_to = "rear + 1", "rear + 2"
    settings.requirements[2].kinds = 2
    return car


def rows(scene):
    return scene.perception_entropy.requirements


def test_a_preset_is_the_engine_s_and_an_own_one_is_edited_by_fields(held):
    study = scenes.study()
    preset, ahead, behind = study.requirements
    shipped = requirement_file.preset("ncap26_reverse_static").requirement(preset.name)
    assert preset == shipped
    assert ahead.zone.x == ("front + 1", "front + 2")
    assert (behind.zone.x, behind.criterion.kinds) == (("rear + 1", "rear + 2"), 2)
    assert [row.name for row in rows(held)] == [each.name for each in study.requirements]
    assert rows(held)[2].name == "My requirement 2", "names are told apart"


def test_each_field_of_the_panel_reads_back_what_was_set(held):
    row = rows(held)[1]
    told = {"step": 0.25, "sensors": 2, "kinds": 2, "one_lost": True, "mounting": True}
    told |= {"body": "child", "x_from": "front + 0.5", "y_from": "-1.5", "y_to": "left + 1"}
    for name, value in told.items():
        setattr(row, name, value)
        assert row.problem == ""
    for name, value in told.items():
        assert getattr(row, name) == pytest.approx(value) if name == "step" else value, name
    made = scenes.study().requirements[1]
    assert made.zone.y == (-1.5, "left + 1") and made.zone.step == 0.25
    assert [body.name for body in made.bodies] == ["child"]
    assert made.under.one_lost and made.under.mounting


def test_a_wrong_value_is_refused_and_said_and_the_requirement_stays(held):
    row = rows(held)[1]
    before = row.table
    row.x_from = "bumper + 1"
    assert row.table == before and "bumper" in row.problem
    row.x_from = "front + 1.5"
    assert row.problem == ""


def test_a_requirement_that_is_switched_off_is_not_in_the_study(held):
    rows(held)[0].enabled = False
    assert [each.name for each in scenes.study().requirements] == [r.name for r in rows(held)][1:]


def test_two_of_one_name_are_refused_in_one_line(held):
    rows(held)[1].name = rows(held)[2].name
    with pytest.raises(pe.InputError, match="My requirement 2"):
        scenes.study()


def test_check_stores_the_verdicts_of_the_engine(held):
    bpy.ops.pe.check_requirements()
    verdicts = scenes.study().verdicts()
    assert {verdict.met for verdict in verdicts} == {True, False}, "both are tried"
    for row, verdict in zip(rows(held), verdicts, strict=True):
        assert (bool(row.met), row.verdict) == (verdict.met, verdict.text)
        assert row.margin_text == verdict.margin_text
        assert tuple(row.worst) == pytest.approx(verdict.worst)
    shown = operators.shown_verdicts(held)
    assert [shown[v.name].met for v in verdicts] == [v.met for v in verdicts]


def test_a_score_stores_them_too_and_an_edit_forgets_one(held):
    assert bpy.ops.pe.score() == {"FINISHED"}
    told = json.loads(held.perception_entropy.result_json)["requirements"]
    assert [row.verdict for row in rows(held)] == [each["text"] for each in told]
    rows(held)[1].step = 0.4
    assert rows(held)[1].met == -1 and rows(held)[0].met >= 0
    assert operators.shown_verdicts(held)[rows(held)[1].name].met is None


def test_removing_one_leaves_the_others(held):
    held.perception_entropy.requirement_index = 1
    names = [row.name for row in rows(held)]
    assert bpy.ops.pe.remove_requirement() == {"FINISHED"}
    assert [row.name for row in rows(held)] == [names[0], names[2]]


def test_the_command_in_blender_says_what_pe_check_says(held, tmp_path):
    blend, study = tmp_path / "car.blend", tmp_path / "study.toml"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    pe.export_study(scenes.study(), study)
    told, answer = pe_here("check", study, "--json"), run_here(blend, "check", "--json")
    assert (told.returncode, answer.returncode) == (3, 3), told.stderr + answer.stderr
    assert json.loads(answer.stdout) == json.loads(told.stdout)


def test_they_come_back_from_a_study_file(held, tmp_path):
    study = scenes.study()
    pe.export_study(study, tmp_path / "study.toml")
    bpy.ops.pe.remove_requirement()
    assert bridge.load_into(held, pe.load_study(tmp_path / "study.toml")) == []
    assert scenes.study().requirements == study.requirements


def test_keep_is_the_search_s(held):
    assert scenes.study().search.requirements is None
    held.perception_entropy.keep_requirements = True
    assert scenes.study().search.requirements == "keep"


class TestZones:
    """The layer of the 3D view."""

    def shape(self, scene):
        (shape,) = scenes.drawn(scene)["requirements"].values()
        return shape

    def test_it_shows_the_verdicts_of_the_engine(self, held):
        shape, verdicts = self.shape(held), scenes.study().verdicts()
        assert [v.to_dict() for v in shape.verdicts] == [v.to_dict() for v in verdicts]
        met = sum(verdict.met for verdict in verdicts)
        assert shape.legend.title == f"{met} of 3 requirements met"

    def test_samples_are_filled_where_met_and_hatched_where_not(self, held):
        """Squares of the passing samples cover the met zones, hatching the failing ones."""
        shape = self.shape(held)
        ahead, behind = shape.verdicts[1:]
        assert ahead.met and not behind.met and not behind.passed.any()
        filled, hatched = shape.faces, shape.thin
        assert (filled.colors[..., :3] == np.float32(MET[:3])).all()
        assert (hatched.colors[..., :3] == np.float32(NOT_MET[:3])).all()
        assert hatched.points[..., 0].max() < 0.0 < filled.points[..., 0].max()
        inside = ahead.samples.points[ahead.samples.inside]
        corners = filled.points.reshape(-1, 3)[:, :2]
        assert np.abs(inside[:, None] - corners[None]).max(axis=2).min(axis=1).max() <= 0.26

    def test_the_selected_one_has_worst_place_margin_and_height(self, held):
        held.perception_entropy.requirement_index = 1
        shape = self.shape(held)
        verdict = shape.verdicts[1]
        texts = [label.text for label in shape.labels]
        assert any(text.startswith(f"worst place: {verdict.body}") for text in texts)
        assert any(f"{verdict.margin:.2f} m" in text for text in texts)
        top = verdict.requirement.bodies[0].size[2]
        assert shape.lines.points[..., 2].max() == pytest.approx(top, abs=1e-5)

    def test_what_a_move_loses_is_named(self, held):
        """The camera turns round: nothing sees the child ahead any more."""
        assert self.shape(held).verdicts[1].met
        name = rows(held)[1].name
        for each in ("eye", "roof"):
            if each in bpy.data.objects:
                bpy.data.objects[each].location.z = 40.0
        for obj in held.objects:
            if obj.perception_entropy.is_sensor:
                obj.location.z = 40.0
        bpy.context.view_layer.update()
        legend = self.shape(held).legend
        assert any(text == f"lost: {name}" for _, text in legend.classes)

    def test_without_requirements_there_is_no_layer(self, held):
        for row in rows(held):
            row.enabled = False
        assert "requirements" not in scenes.drawn(held)


def test_the_ground_map_of_redundancy_has_the_engine_s_numbers(held):
    view = held.perception_entropy.view
    view.ground_quantity, view.redundancy_height, view.ground_opacity = "REDUNDANCY", 1.0, 1.0
    study = scenes.study()
    maker = pe.requirements.Redundancy(study.vehicle, study.space, 1.0, within=20.0, step=0.5)
    seen = maker.map(study.rig)
    counts = np.float32(graphics.COUNTS)
    wanted = {
        "SENSORS_LEFT": seen.sensors_left,
        "KINDS": seen.kinds,
        "KINDS_LEFT": seen.kinds_left,
    }
    assert {int(values.max()) for values in wanted.values()} == {1, 2}, "they differ"
    for name, values in wanted.items():
        view.redundancy_of = name
        (shape,) = scenes.drawn(held)["ground"].values()
        known = values >= 0
        shown = shape.sheet.image[..., :3].transpose(1, 0, 2)
        assert np.allclose(shown[known], counts[values[known]], atol=1e-6), name
        assert "1 m tall" in shape.legend.title
