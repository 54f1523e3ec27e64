"""What the 3D view shows of a search that runs: the best placement so far."""

from types import SimpleNamespace

import bpy
import pytest

from blender_addon.engine import jobs, pe, search
from blender_addon.operators.running_job import RunningJob
from blender_addon.panels import search_panels
from blender_addon.view import best_so_far
from tests.addon import layouts, scenes


def test_the_best_so_far_is_shown_as_ghosts_until_the_search_ends(car):
    car.perception_entropy.view.show_ghosts = True
    sensor = bpy.data.objects["roof"]
    found = scenes.study().rig
    moved = found.with_poses([search.pose_from_values({**values(found), "x": 0.5})])
    best_so_far.searches[car.name] = tuple(moved)
    (shape,) = scenes.drawn(car)["ghosts"].values()
    assert shape.legend.title == "Search" and shape.legend.classes[0][1] == "best so far"
    assert [tag.place[0] for tag in shape.labels] == [0.5]
    assert sensor.location.x == pytest.approx(-0.43)  # nothing was moved
    del best_so_far.searches[car.name]
    assert "ghosts" not in scenes.drawn(car)


def values(rig):
    return search.pose_values(rig["roof"].pose)


class Manager:
    """A window manager without windows, that only counts."""

    windows = ()

    def event_timer_add(self, *_args, **_more):
        return None

    def progress_begin(self, *_):
        pass

    progress_update = progress_begin


def lines_while_running(scene, job, monkeypatch):
    """Run a search, which the view shows at each step; return the lines of its progress."""
    status = SimpleNamespace(status_text_set=lambda _: None)
    context = SimpleNamespace(scene=scene, window_manager=Manager(), window=None, workspace=status)
    running = RunningJob(context, job, "outcome")
    running.seen = job
    monkeypatch.setattr("blender_addon.operators.running_job.BEST_EVERY_S", 0.0)
    lines = []
    for progress in job:
        running.progress = progress
        running.show(context)
        lines.append(running.text)
    return lines


def test_a_running_search_tells_the_view_each_time_it_finds_better(car, monkeypatch):
    car.perception_entropy.interval = 0.5
    job = jobs.OptimizeJob(scenes.study())
    lines = lines_while_running(car, job, monkeypatch)
    best_lines = [line for line in lines if line.startswith("Optimizing")]
    values = [float(line.split()[-1]) for line in best_lines if "best" in line]
    assert values[-1] == round(job.curve[-1][1].objective, 3) < values[0]
    assert values == sorted(values, reverse=True), "of one sample each"
    assert best_so_far.searches.pop(car.name) == tuple(job.best.rig) != tuple(job.study.rig)


def test_the_schedule_is_shown_and_written_for_the_method_that_has_it(car):
    """The candidates of one method stood beside every other, which did not use them."""
    window = layouts.Window(car)
    settings = car.perception_entropy
    settings.interval = 0.5
    settings.panels = "ALL"
    for name in search.METHODS:
        settings.method = name
        drawn = layouts.drawn(search_panels.search, **vars(window)).texts("prop")
        table = pe.study_to_dict(scenes.study())["optimize"]
        has_schedule = name == search.SCHEDULED_METHOD
        assert ("candidates" in drawn) == ("candidates" in table) == has_schedule, name
    assert bpy.ops.pe.optimize() == {"FINISHED"}
