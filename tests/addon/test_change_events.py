"""What moves is told while it moves and once it rests; what does not concern the score is not."""

import bpy
import pytest

from blender_addon import signals, wiring
from blender_addon.caches import change_events
from tests.addon import scenes

MOVED = "moved"
RESTED = "rested"


class Timers:
    """Blender's timers and the time, as a test wants them."""

    def __init__(self):
        self.now = 0.0
        self.waiting = {}

    def is_registered(self, function):
        return function in self.waiting

    def register(self, function, first_interval):
        self.waiting[function] = self.now + first_interval

    def unregister(self, function):
        del self.waiting[function]

    def monotonic(self):
        return self.now

    def pass_by(self, seconds):
        """Let time pass, and call what is due."""
        end = self.now + seconds
        while self.waiting and min(self.waiting.values()) <= end:
            self.now = max(min(self.waiting.values()), self.now)
            self._call_due()
        self.now = end

    def _call_due(self):
        """As Blender does: in the order of registration; a timer is registered while it runs."""
        for function, at in list(self.waiting.items()):
            if at > self.now:
                continue
            again = function()
            if again is not None:
                self.waiting[function] = self.now + again
            else:
                del self.waiting[function]


@pytest.fixture
def timers(monkeypatch, car):
    """A window on the car, as far as motion sees one."""
    made = Timers()
    app = type("App", (), {"timers": made, "background": False, "handlers": bpy.app.handlers})
    seen = type("Bpy", (), {"app": app, "types": bpy.types})
    monkeypatch.setattr(change_events, "bpy", seen)
    monkeypatch.setattr(change_events, "time", made)
    car.perception_entropy.show_overlay = False  # what is drawn is worked out whenever it rests
    drag(car.objects["roof"])  # from here on it is known what there is
    made.pass_by(10.0)
    yield made
    for function in list(made.waiting):
        made.unregister(function)


@pytest.fixture
def heard(timers):
    """What is told, as it comes, from now on."""
    told = []
    listeners = {signals.moving: lambda: told.append(MOVED)}
    listeners[signals.idle] = lambda: told.append(RESTED)
    for signal, listener in listeners.items():
        signal.connect(listener)
    yield told
    for signal, listener in listeners.items():
        signal.disconnect(listener)


def drag(obj):
    obj.location.x += 0.1
    bpy.context.view_layer.update()


def test_a_drag_is_reported_as_long_as_it_lasts_and_its_rest_once(car, timers, heard):
    for _ in range(5):
        drag(car.objects["roof"])
        timers.pass_by(0.1)
    assert heard == [MOVED] * 5
    timers.pass_by(10.0)
    assert heard == [MOVED] * 5 + [RESTED] and not timers.waiting


def test_a_drag_is_no_rest_where_a_redraw_takes_longer_than_the_wait(car, timers, heard):
    for _ in range(5):
        drag(car.objects["roof"])
        timers.now += 2.0 * change_events.IDLE_S
        timers.pass_by(0.1)  # timers are called before the mouse's next event
    assert heard == [MOVED] * 5
    timers.pass_by(10.0)
    assert heard == [MOVED] * 5 + [RESTED] and not timers.waiting


def move_a_point(car):
    car.objects["body"].data.vertices[0].co.x += 0.1
    car.objects["body"].data.update()


def follow_a_parent(car):
    parent = bpy.data.objects.new("mast", None)
    car.collection.objects.link(parent)
    car.objects["roof"].parent = parent
    bpy.context.view_layer.update()
    parent.location.x += 0.1


def play(car):
    sensor = car.objects["roof"]
    sensor.keyframe_insert("location", frame=1)
    sensor.location.x += 1.0
    sensor.keyframe_insert("location", frame=10)
    car.frame_set(5)


@pytest.mark.parametrize(
    "change",
    [
        lambda car: drag(car.objects["cabin"]),
        move_a_point,
        follow_a_parent,
        play,
        lambda car: setattr(car.objects["roof"].perception_entropy, "model", "Pandar40"),
        lambda car: bpy.data.objects.remove(car.objects["roof"]),
        lambda car: bpy.data.objects.remove(car.objects["cabin"]),
        lambda car: car.objects["roof"].hide_set(True),
        lambda car: setattr(car.objects["cabin"], "hide_viewport", True),
        lambda car: scenes.add_sensor("second"),
    ],
    ids=[
        "part",
        "points",
        "parent",
        "frame",
        "model",
        "sensor gone",
        "part gone",
        "sensor hidden",
        "part hidden",
        "sensor added",
    ],
)
def test_whatever_changes_a_sensor_or_the_vehicle_is_reported(car, timers, heard, change):
    change(car)
    bpy.context.view_layer.update()
    timers.pass_by(10.0)
    assert MOVED in heard and heard[-1] == RESTED


def test_what_concerns_no_score_is_not_told(car, timers, heard):
    other = bpy.data.objects.new("lamp", None)
    car.collection.objects.link(other)
    drag(other)
    other.select_set(True)
    bpy.context.view_layer.update()
    timers.pass_by(10.0)
    assert heard == []


@pytest.mark.parametrize("name", ["undo_post", "redo_post", "load_post", "frame_change_post"])
def test_what_blender_calls_after_a_step_back_or_a_load_is_reported(car, timers, heard, name):
    """Whether or not an update of the scene follows, in which objects seem to have changed."""
    ours = [f for f in getattr(bpy.app.handlers, name) if f.__module__ == wiring.__name__]
    assert len(ours) == 1
    car.objects["roof"].location.x += 0.1  # without an update
    for handler in ours:
        handler(car, bpy.context.evaluated_depsgraph_get())
    timers.pass_by(10.0)
    assert heard == [MOVED, RESTED]
