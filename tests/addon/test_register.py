"""Registering, unregistering, and what is left behind: nothing."""

import subprocess
import sys
from pathlib import Path

import bpy
import pytest

import blender_addon
from blender_addon import signals, wiring
from blender_addon.caches import change_events, sensor_cache
from blender_addon.operators import running_job
from blender_addon.overlay import scheduler
from blender_addon.view import viewport
from tests.addon import layouts

ROOT = Path(blender_addon.__file__).parents[1]
ROUNDS = 3


SIGNALS = (
    signals.study_changed,
    signals.view_changed,
    signals.moving,
    signals.idle,
    signals.live_toggled,
    signals.live_score_changed,
)
TIMERS = (change_events.emit_moving, change_events.emit_idle, scheduler.update_now)
TOY = """
import sys
from os import _exit
from dataclasses import make_dataclass, replace
from types import SimpleNamespace

from pe_core import sensors
from pe_core.base.setting import Panel, setting
from pe_core.base.values import Number
from pe_core.sensors import weather

hail = setting(0.0, Number(0.0, 90.0, unit="m"), "Size of hailstones", Panel("hail", "Hail"))
Toy = make_dataclass("Weather", [("hail", float, hail)], bases=(weather.Weather,), frozen=True)
weather.Weather = sensors.Weather = Toy

import bpy
import blender_addon
from blender_addon import document
from blender_addon.panels.condition_panel import conditions
from pe_core import study as studies
from pe_core.study.study_file import study_bytes
from tests.addon import layouts, scenes
from tests.engine.test_settings import settings_page

blender_addon.register()
bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
scene = bpy.context.scene
scene.perception_entropy.vehicle = scenes.add_car(scene)
scenes.add_sensor("roof", location=(0.0, 0.0, 2.5))
row = scene.perception_entropy.weathers.add()
row.name = "storm"
field = row.bl_rna.properties["hail"]
assert (field.name, field.description) == ("Hail", "Size of hailstones")
assert (field.hard_max, field.unit) == (90.0, "LENGTH")
row.hail = 0.4
study = document.study_as_drawn(scene)
assert study.conditions.weathers == (Toy("storm", hail=0.4),)
assert b"hail = 0.4" in study_bytes(study)
again = studies.study_from_dict(studies.study_to_dict(replace(study, vehicle=None, mesh=None)))
assert again.conditions == study.conditions
row.hail = 7.0
assert document.load_into(scene, study) == []
assert document.study_as_drawn(scene).conditions == study.conditions
assert ("prop", "hail") in layouts.drawn(conditions, **vars(layouts.Window(scene))).notes
assert "- `hail` ([m], 0–90, `0.0`): Size of hailstones" in settings_page().page()
print("seen everywhere")
sys.stdout.flush()
_exit(0)
"""


def traces() -> dict[str, list[str]]:
    """Return everything of ours that Blender knows."""
    lists = {name: getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)}
    functions = [f for each in lists.values() if isinstance(each, list) for f in each]
    carriers = (bpy.types.Scene, bpy.types.Object, bpy.types.WindowManager)
    return {
        "classes": [name for name in dir(bpy.types) if name.startswith("PE_")],
        "handlers": [f.__name__ for f in functions if f.__module__.startswith("blender_addon")],
        "properties": [c.__name__ for c in carriers if hasattr(c, "perception_entropy")],
        "listeners": [f.__name__ for s in SIGNALS for f in s.listeners],
        "timers": [f.__name__ for f in TIMERS if bpy.app.timers.is_registered(f)],
    }


def extended_menus() -> list[str]:
    """Return the menus and panels of Blender that something of ours draws into."""
    found = []
    for name in dir(bpy.types):
        draw = getattr(getattr(bpy.types, name), "draw", None)
        ours = (f.__module__ for f in getattr(draw, "_draw_funcs", ()))
        found += [name for module in ours if module.startswith("blender_addon")]
    return found


@pytest.fixture
def view3d(monkeypatch):
    """Return a stand-in for the 3D views: Blender does not tell what is drawn into its own."""
    monkeypatch.setattr(viewport, "VIEW", layouts.View3D)
    return layouts.View3D


def test_rounds_leave_nothing_behind(unregistered, view3d):
    before = traces()
    kept = None
    assert not any(before.values())
    for _ in range(ROUNDS):
        blender_addon.register()
        assert len(view3d.handles) == 2  # in space, and over it
        for timer in TIMERS:  # a change just before it is switched off
            bpy.app.timers.register(timer)
        sensor_cache.sensors(bpy.context.scene)
        kept = kept or traces()
        assert traces() == kept
        blender_addon.unregister()
        assert traces() == before
        assert not view3d.handles
    assert all(kept[each] for each in ("classes", "handlers", "properties", "listeners", "timers"))
    assert running_job.current is None and not extended_menus()


@pytest.fixture
def heard():
    """Return what the signals tell, as it comes."""
    told = []
    listeners = {
        signals.study_changed: lambda: told.append("study"),
        signals.view_changed: lambda: told.append("picture"),
    }
    for signal, listener in listeners.items():
        signal.connect(listener)
        signal.connect(listener)  # asked for twice, called once
    yield told
    for signal, listener in listeners.items():
        signal.disconnect(listener)
        signal.disconnect(listener)
        assert listener not in signal.listeners


def test_a_change_is_reported_to_those_who_listen(car, heard):
    settings = car.perception_entropy
    settings.view.beam_limit = 10
    assert heard == ["picture"]
    settings.score_samples = 10
    assert heard == ["picture", "study"]
    car.objects["roof"].perception_entropy.model = "Pandar40"
    bpy.ops.pe.add_row(rows="focus")
    assert len(heard) > 3 and set(heard[2:]) == {"study"}


def test_a_handler_calls_its_functions_in_order_whatever_one_of_them_does(monkeypatch, capsys):
    called = []

    def broken(*_):
        called.append("broken")
        raise ValueError("odd")

    functions = (lambda *args: called.append(args), broken, lambda *_: called.append("last"))
    monkeypatch.setitem(wiring.EVENTS, "undo_pre", functions)
    wiring.HANDLERS["undo_pre"]("scene", "depsgraph")
    assert called == [("scene", "depsgraph"), "broken", "last"]
    assert "ValueError: odd" in capsys.readouterr().err


def test_a_job_ends_with_the_extension(car, monkeypatch):
    """Nothing of it shows any more, and after enabling again a new one can begin."""
    shown = []

    class Shown(running_job.RunningJob):
        """A job without a window to show it in."""

        def __init__(self):
            pass

        def release_window(self, context):
            shown.append(context)

        def end(self, context):
            shown.append(context)

    monkeypatch.setattr(running_job, "current", Shown())
    assert not bpy.ops.pe.score.poll()
    blender_addon.unregister()
    try:
        assert running_job.current is None and len(shown) == 2
    finally:
        blender_addon.register()
    assert bpy.ops.pe.score.poll() and bpy.ops.pe.optimize.poll()


def test_a_new_setting_is_one_row_seen_in_file_property_scene_panel_and_docs():
    """In a process of its own, before anything has read the declarations."""
    answer = subprocess.run(
        [sys.executable, "-c", TOY], cwd=ROOT, capture_output=True, text=True, timeout=600
    )
    assert answer.stdout.endswith("seen everywhere\n"), answer.stderr
