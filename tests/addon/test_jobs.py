"""Score and optimize from the scene: the engine's own numbers, to the bit."""

import math
from dataclasses import replace
from types import SimpleNamespace

import bpy
import pytest

import pe_tools as pt
from blender_addon.caches import result_staleness
from blender_addon.engine import jobs as pe_jobs
from blender_addon.engine import pe
from blender_addon.operators import declared, jobs, running_job
from blender_addon.panels import main
from tests.addon import layouts, scenes
from tests.engine.processes import finished

ESC = SimpleNamespace(type="ESC", value="PRESS")
TICK = SimpleNamespace(type="TIMER", value="NOTHING")
UNDO = SimpleNamespace(type="Z", value="PRESS", ctrl=True, oskey=False)


def test_what_a_search_cost_is_stored_and_shown(car):
    car.perception_entropy.score_samples = car.perception_entropy.search_samples = 1024
    expected = finished(pt.OptimizeJob(scenes.study()))
    assert bpy.ops.pe.optimize() == {"FINISHED"}
    settings = car.perception_entropy
    assert settings.result.cost == expected.cost
    told = [settings.result.figures[which] for which in ("before", "after")]
    assert told == [figures.to_dict() for figures in expected.figures]
    labels = " ".join(layouts.drawn(main.main, **vars(layouts.Window(car))).texts("label"))
    up = [
        f"{math.ceil(10.0 * figures.values['blind_ground']) / 10.0:.1f}"
        for figures in expected.figures
    ]
    assert f"Blind ground {up[1]} m²" in labels and (up[0] == up[1] or f"({up[0]})" in labels)
    assert expected.cost.split("(")[0].strip() in labels
    ends = [f"{each.entropy:.3f}" for each in (expected.before, expected.after)]
    assert f"entropy {ends[0]} to {ends[1]} nats" in jobs.search_line(expected)
    assert ends[1] in labels, "the digits of the dashboard"


def test_one_job_at_a_time(car, monkeypatch):
    monkeypatch.setattr(running_job, "current", object())
    assert not bpy.ops.pe.score.poll()
    with pytest.raises(RuntimeError, match="Another score, search or export is running"):
        bpy.ops.pe.optimize()
    assert bpy.ops.pe.cancel.poll()
    monkeypatch.setattr(running_job, "current", None)
    assert not bpy.ops.pe.cancel.poll()


class Manager:
    """A window manager without windows."""

    windows = ()
    event_timer_add = event_timer_remove = progress_begin = progress_end = lambda *_, **__: None


class Broken(pt.ScoreJob):
    def __iter__(self):
        yield pt.Progress("scoring", 0.5)
        raise pe.InputError("job", "work", "none", "any")


def test_a_job_that_the_engine_runs_tells_how_it_ended(car):
    context = SimpleNamespace(scene=car, window_manager=Manager(), window=None)
    job = pt.OptimizeJob(scenes.study())
    running = running_job.RunningJob(context, job, "outcome")
    assert not running.ended
    running.start()  # without a window it is done at once
    assert running.ended and running.error is None
    assert running.found.evaluations == running.seen.evaluations > 0 == job.evaluations
    assert running.seen.best.rig != job.study.rig and running.seen.best.vehicle is job.study.vehicle
    running = running_job.RunningJob(context, Broken(scenes.study()), "outcome")
    running.start()
    assert running.ended and isinstance(running.error, pe.InputError)
    assert running.progress.fraction == 0.5


class Silent:
    """The engine's process that never answers, and never ends."""

    def __init__(self):
        self.asked = []
        self.cancelled = []

    def ask(self, topic, *_, **__):
        self.asked.append(topic)

    def cancel(self, topic):
        self.cancelled.append(topic)

    def drop(self, topic):
        self.asked.remove(topic)


def begun(car, row, monkeypatch):
    """Return the operator of a job that the engine never answers, with its engine and context."""
    engine = Silent()
    for name in ("ask", "cancel", "drop"):
        monkeypatch.setattr(running_job.engine_process, name, getattr(engine, name))
    monkeypatch.setattr(running_job.RunningJob, "show", lambda *_: None)
    context = SimpleNamespace(scene=car, window_manager=Manager(), window=None)
    task = row.read(Window(car))
    operator = type("Operator", (jobs.JobOperator,), {"row": row, "report": lambda *_: None})()
    operator.task = task
    operator.running = running_job.begin(context, task.job, task.outcome)
    return operator, engine, context


def improved(car, seen):
    """Have a search that runs elsewhere know a better placement; return it."""
    pose = seen.study.rig["roof"].pose
    higher = replace(pose, position=(*pose.position[:2], pose.position[2] + 0.25))
    rig = pe.Rig([each.moved(higher) if each.name == "roof" else each for each in seen.study.rig])
    seen.history = [pe_jobs.HistoryRow(8, 0, pe.Value(0.0, 1.0), rig)]
    return higher


@pytest.mark.parametrize("row", [jobs.OPTIMIZE, jobs.SCORE])
def test_esc_gives_the_window_back_though_the_engine_never_answers(car, row, monkeypatch):
    operator, engine, context = begun(car, row, monkeypatch)
    assert operator.modal(context, UNDO) == {"RUNNING_MODAL"}
    best = improved(car, operator.running.seen) if row is jobs.OPTIMIZE else None
    operator.modal(context, ESC)
    assert running_job.current is None and engine.cancelled
    if best is not None:
        assert scenes.study().rig["roof"].pose == best
        names = [each.name for each in car.perception_entropy.variants]
        assert len(names) == 2, "start and best so far are kept"
        assert engine.asked, "its result is awaited"
        for event in (TICK, ESC, UNDO):
            assert operator.modal(context, event) == {"PASS_THROUGH"}
        assert bpy.ops.pe.optimize.poll(), "another job may begin"
    operator.cancel(context)  # the file is closed
    assert not engine.asked and not running_job.stopped


@pytest.mark.parametrize("moved", [False, True])
def test_the_result_of_a_stopped_search_comes_later(car, moved, monkeypatch):
    operator, _, context = begun(car, jobs.OPTIMIZE, monkeypatch)
    best = improved(car, operator.running.seen)
    operator.modal(context, ESC)
    start = operator.task.job.study
    found = finished(pt.ScoreJob(start.with_rig(operator.running.seen.best.rig)))
    operator.running.found = replace(found, kind="optimize", start=start)
    operator.running.ended = True
    if moved:
        car.objects["roof"].location.z += 0.125
        bpy.context.view_layer.update()
    operator.modal(context, TICK)
    settings = car.perception_entropy
    assert settings.has_result is not moved, "sensors that were moved since are left where they are"
    assert (scenes.study().rig["roof"].pose == best) is not moved
    assert [each.has_result for each in settings.variants] == [True, True]
    assert not running_job.stopped and scenes.study().rig["roof"].pose != start.rig["roof"].pose


def test_result_goes_stale_and_comes_back(car):
    settings = car.perception_entropy
    sensor = car.objects["roof"]
    bpy.ops.pe.score()
    result_staleness.update_result()
    assert not settings.result_stale
    changes = ((sensor, "location", (0.0, 0.0, 2.0)), (settings, "prior", "uniform"))
    changes += ((sensor.perception_entropy, "model", "HDL-64E"),)
    changes += ((car.objects["body"], "location", (0.0, 0.0, 1.0)),)
    changes += ((car.objects["body"], "hide_render", True),)
    changes += ((car.objects["body"].data.vertices[0], "co", (-3.0, 0.0, 0.0)),)
    for owner, name, value in changes:
        before = getattr(owner, name)
        before = before.copy() if name in ("location", "co") else before
        for new, expected in ((value, True), (before, False)):
            setattr(owner, name, new)
            car.objects["body"].data.update()
            bpy.context.view_layer.update()
            result_staleness.update_result()
            assert settings.result_stale == expected, (name, new)


class Window:
    """What a modal operator is given, as far as a job that is stepped by hand needs it."""

    def __init__(self, scene):
        self.scene = scene

    def evaluated_depsgraph_get(self):
        return bpy.context.evaluated_depsgraph_get()


def animate(sensor):
    sensor.keyframe_insert("location", frame=1)


def drive(sensor):
    sensor.driver_add("rotation_euler", 1)


def constrain(sensor):
    sensor.constraints.new("COPY_LOCATION")


@pytest.mark.parametrize("hold", [animate, drive, constrain])
def test_a_sensor_that_something_holds_is_reported_before_the_work(car, hold, monkeypatch):
    sensor = car.objects["roof"]
    hold(sensor)
    monkeypatch.setattr(jobs.jobs, "OptimizeJob", lambda *_, **__: pytest.fail("begun"))
    with pytest.raises(RuntimeError, match="sensor 'roof': placement: expected an object that can"):
        bpy.ops.pe.optimize()
    sensor.perception_entropy.free = (False,) * 6
    scenes.add_sensor("free")
    monkeypatch.undo()
    assert bpy.ops.pe.score() == {"FINISHED"}


@pytest.mark.parametrize("stops", [1, 2])
def test_esc_keeps_the_best_with_its_analysis_and_esc_again_without(car, stops):
    task = jobs.OPTIMIZE.read(Window(car))
    run = pe_jobs.JobRun(task.job)
    analysed = stops == 1
    for step in run:
        if step.progress.stage == "optimizing" and step.progress.evaluations >= 8:
            for _ in range(stops):
                run.cancel(drop=False)
            stops = 0
    assert task.job.outcome.stopped
    jobs.OPTIMIZE.finish(car, task, task.job.outcome, task.job)
    stored = car.perception_entropy.result
    assert scenes.study().rig["roof"].pose == task.job.best.rig["roof"].pose
    assert bool(stored.robustness("rise")) is analysed


def test_a_dropped_search_leaves_all_as_it_was(car):
    before = scenes.study().rig["roof"].pose
    task = jobs.OPTIMIZE.read(Window(car))
    run = pe_jobs.JobRun(task.job)
    for step in run:
        if step.progress.evaluations >= 8:
            run.cancel(drop=True)
    with pytest.raises(declared.Stopped):
        jobs.OPTIMIZE.finish(car, task, task.job.outcome, task.job)
    assert scenes.study().rig["roof"].pose == before and not car.perception_entropy.has_result
