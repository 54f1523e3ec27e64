"""Requirements in the scene: one record with the study file, verdicts of the engine to the bit."""

import bpy
import numpy as np
import pytest

from blender_addon import document
from blender_addon.operators import jobs
from blender_addon.operators import requirements as operators
from blender_addon.overlay.requirement_zones import MET, NOT_MET
from blender_addon.overlay.snapshot import SnapshotReader
from blender_addon.processes import analysis_calls
from pe_core.study import requirement_file
from tests.addon import scenes

AHEAD = 'x = ["front + 1", "front + 2"], y = ["right", "left"]'


@pytest.fixture
def held(car):
    """A car with a LiDAR and a camera at its front, held to a preset and two own requirements."""
    scenes.seen_rig(car)
    settings = car.perception_entropy
    settings.score_samples = 4096
    settings.requirements.clear()
    for preset in ("ncap26_reverse_static", "OWN", "OWN"):
        assert bpy.ops.pe.add_row(rows="requirements", kind=preset) == {"FINISHED"}
    settings.requirements[1].zone = AHEAD
    settings.requirements[2].zone = AHEAD.replace("front", "rear")
    settings.requirements[2].kinds = 2
    return car


def rows(scene):
    return scene.perception_entropy.requirements


def stored(scene):
    """The last verdicts as the file keeps them: values, or why there is none."""
    return [document.stored_verdict(row) for row in rows(scene)]


def test_a_preset_is_the_engine_s_and_an_own_one_is_edited_by_fields(held):
    study = scenes.study()
    preset, ahead, behind = study.requirements
    shipped = requirement_file.preset("ncap26_reverse_static").requirement(preset.name)
    assert preset == shipped
    assert ahead.zone.x == ("front + 1", "front + 2")
    assert (behind.zone.x, behind.criterion.kinds) == (("rear + 1", "rear + 2"), 2)
    assert [row.name for row in rows(held)] == [each.name for each in study.requirements]
    assert rows(held)[2].name == "My requirement 2", "names are told apart"


def test_the_zone_takes_each_shape(held):
    row = rows(held)[1]
    row.shape = "path"
    row.zone = 'path = [["front + 1", -2.0], ["front + 1", "left + 0.5"]]'
    made = scenes.study().requirements[1].zone
    assert made.path == (("front + 1", -2.0), ("front + 1", "left + 0.5")) and made.x is None
    for shape in ("spots", "ring", "polygon", "area"):
        row.shape = shape
        assert (row.shape, row.problem) == (shape, "")
        scenes.study()
    row.zone = "ring = [0.2, 0.6]"
    assert row.shape == "ring" and scenes.study().requirements[1].zone.ring == (0.2, 0.6)
    for wrong in ("ring = [0.2", "ring = 3", "circle = 2", ""):
        row.zone = wrong
        assert row.problem and row.zone == "ring = [0.2, 0.6]", wrong


def test_bodies_are_one_several_or_of_an_own_size(held):
    row = rows(held)[1]
    row.bodies = "child, cyclist"
    assert [body.name for body in scenes.study().requirements[1].bodies] == ["child", "cyclist"]
    for wrong in ("child, horse", "size = [0.4", "size = 3"):
        row.bodies = wrong
        assert row.problem and row.bodies == "child, cyclist", wrong
    row.bodies = "size = [0.4, 0.6, 1.2], low = 0.3, headings = [0, 45]"
    (own,) = scenes.study().requirements[1].bodies
    assert own.size == pytest.approx((0.4, 0.6, 1.2)) and own.low == pytest.approx(0.3)
    assert np.rad2deg(own.headings) == pytest.approx([0.0, 45.0])
    row.bodies = 'diameter = 0.3, height = 1.2, class = "pedestrian"'
    (own,) = scenes.study().requirements[1].bodies
    assert own.is_round and own.size == pytest.approx((0.3, 0.3, 1.2))
    row.bodies = '{ size = [0.4, 0.6, 1.2] }, { name = "adult" }'
    assert len(scenes.study().requirements[1].bodies) == 2
    row.bodies = row.bodies
    assert row.problem == "" and len(scenes.study().requirements[1].bodies) == 2


def test_check_stores_the_verdicts_of_the_engine(held):
    bpy.ops.pe.check_requirements()
    verdicts = scenes.study().verdicts()
    assert {verdict.met for verdict in verdicts} == {True, False}, "both are tried"
    assert stored(held) == [verdict.summary for verdict in verdicts]
    shown = operators.shown_verdicts(held)
    assert [shown[v.name].met for v in verdicts] == [v.met for v in verdicts]


def check_by_hand(scene, after_a_step):
    """Step a check as a window does; return what it reports."""
    task = jobs.CHECK.read(bpy.context)
    for _ in task.job:
        task.progressed(scene, task.job)
        after_a_step(task.job)
    return jobs.CHECK.finish(scene, task, task.job.checked, task.job)


def test_verdicts_come_row_by_row_and_esc_keeps_those_that_are_found(held):
    bpy.ops.pe.check_requirements()
    whole = stored(held)
    counts = []

    def note(job):
        counts.append(len(stored(held)) - stored(held).count(None))

    check_by_hand(held, note)
    assert counts == sorted(counts) and {*counts} == {0, 1, 2, 3}
    assert stored(held) == whole

    told = check_by_hand(held, lambda job: job.stop() if job.verdicts else None)
    assert told.level == "WARNING"
    first, *others = stored(held)
    assert first.met == whole[0].met and others == [None, None]

    check_by_hand(held, lambda job: job.stop() if job.margins else None)
    first, *others = stored(held)
    assert first == whole[0], "its margin is known"
    assert [each.met for each in others] == [each.met for each in whole[1:]]


class TestZones:
    """The layer of the 3D view."""

    def shape(self, scene):
        (shape,) = scenes.drawn(scene)["requirements"].values()
        return shape

    def test_it_shows_the_verdicts_of_the_engine(self, held):
        shape = self.shape(held)
        verdicts = scenes.study().verdicts()
        assert list(shape.verdicts) == [verdict.summary for verdict in verdicts]
        met = sum(verdict.met for verdict in verdicts)
        assert shape.legend.title == f"{met} of 3 requirements met"

    def steps(self, scene):
        """The shapes for the time being, and the last one."""
        depsgraph = bpy.context.evaluated_depsgraph_get()
        request = SnapshotReader().request(scene, depsgraph, False)
        steps = analysis_calls.layer_shapes(request, "requirements", False, [""])
        early = []
        with pytest.raises(StopIteration) as end:
            while True:
                early += [step] if (step := next(steps)) is not None else []
        return [shape for (shape,) in early], end.value.value[0]

    def test_zones_are_there_before_the_margins(self, held):
        """One shape for the time being: every requirement, met or not as at the end."""
        (first,), last = self.steps(held)
        assert [verdict.met for verdict in first.verdicts] == [each.met for each in last.verdicts]
        assert len(last.verdicts) == 3

    def test_what_a_move_lost_is_told_with_the_first_zones(self, held):
        self.steps(held)
        for name in ("eye", "roof"):
            bpy.data.objects[name].location = (0.0, 0.0, 0.5)  # within the body
        (first,), last = self.steps(held)
        news = [text for _, text in last.legend.classes if text.startswith("lost: ")]
        assert news and news == [
            text for _, text in first.legend.classes if text.startswith("lost: ")
        ]

    def test_samples_are_filled_where_met_and_hatched_where_not(self, held):
        """Squares of the passing samples cover the chosen zone, hatching those that fail."""
        held.perception_entropy.requirement_index = 1
        shape = self.shape(held)
        ahead, behind = scenes.study().verdicts()[1:]
        assert ahead.met and not behind.met and not behind.passed.any()
        filled = shape.faces
        hatched = shape.thin
        assert (filled.colors[..., :3] == np.float32(MET[:3])).all()
        assert (hatched.colors[..., :3] == np.float32(NOT_MET[:3])).all()
        assert hatched.points[..., 0].max() < 0.0 < filled.points[..., 0].max()
        inside = ahead.samples.points[ahead.samples.inside]
        corners = filled.points.reshape(-1, 3)[:, :2]
        assert np.abs(inside[:, None] - corners[None]).max(axis=2).min(axis=1).max() <= 0.26
        held.perception_entropy.requirement_index = 2
        assert not len(self.shape(held).faces.points), "what is met needs no look"

    def test_the_selected_one_has_worst_place_margin_and_height(self, held):
        held.perception_entropy.requirement_index = 1
        shape = self.shape(held)
        verdict = scenes.study().verdicts()[1]
        texts = [label.text for label in shape.labels]
        assert any(text.startswith(f"worst place: {verdict.body}") for text in texts)
        assert any(f"{verdict.margin:.2f} m" in text for text in texts)
        top = verdict.requirement.bodies[0].size[2]
        assert shape.lines.points[..., 2].max() == pytest.approx(top, abs=1e-5)
