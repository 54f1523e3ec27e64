"""A redraw takes what is ready: nothing is read, cast, worked out or uploaded twice."""

import contextlib
from types import SimpleNamespace

import bpy
import pytest

from blender_addon import document
from blender_addon.caches import vehicle_cache
from blender_addon.engine import graphics, pe, sight
from blender_addon.overlay import draw_handler, scheduler, surroundings
from blender_addon.overlay.layer_cache import shown_of
from blender_addon.processes import engine_process
from tests.addon import scenes


@pytest.fixture
def rig(car):
    """The car with a LiDAR on its roof and a camera at its front, all layers on."""
    return scenes.seen_rig(car)


class Gpu:
    """Stands for the graphics card: notes what is uploaded and drawn."""

    def __init__(self):
        self.uploaded = 0
        self.drawn = []
        self.written = []
        state = ("blend_get", "depth_test_get", "depth_mask_get")
        asked = {name: lambda: "NONE" for name in state}
        told = {name.replace("get", "set"): lambda _: None for name in state}
        self.state = SimpleNamespace(**asked, **told)

    def of(self, shape):
        self.uploaded += 1
        return SimpleNamespace(
            shape=shape,
            draw_areas=lambda: self.drawn.append(shape),
            draw_lines=lambda *_, **__: None,
        )

    def draw_labels(self, _context, labels, _taken):
        self.written += [label.text for label in labels]

    def legend_plates(self, legends, _room):
        self.written += [text for legend in legends for text in (legend.title, *legend.values)]
        return []

    def draw_plates(self, context, drawer, *, vehicle, taken):
        drawer(context, None)
        return list(taken)


@pytest.fixture
def window(rig, monkeypatch):
    """A 3D view without a graphics card: what a redraw asks for is noted."""
    card = Gpu()
    overlay = SimpleNamespace(show_overlays=True)
    space = SimpleNamespace(type="VIEW_3D", overlay=overlay, local_view=None, camera=None)
    space.region_quadviews = ()
    look = SimpleNamespace(view_perspective="PERSP")
    region = SimpleNamespace(as_pointer=lambda: 1)
    monkeypatch.setattr(draw_handler.viewport, "is_lower_left", lambda _context: False)
    context = SimpleNamespace(scene=rig, space_data=space, region_data=look, region=region)
    context.active_object = None
    monkeypatch.setattr(draw_handler, "bpy", SimpleNamespace(context=context, app=bpy.app))
    monkeypatch.setattr(draw_handler, "gpu", card)
    monkeypatch.setattr(draw_handler, "Batches", card)
    monkeypatch.setattr(draw_handler, "labels", card)
    monkeypatch.setattr(draw_handler.plates, "draw", card.draw_plates)
    monkeypatch.setattr(surroundings, "gpu", card)
    monkeypatch.setattr(surroundings, "Batches", card)
    monkeypatch.setattr(draw_handler, "depth_offset", lambda *_: contextlib.nullcontext())
    visible = {"roof": True, "eye": True}
    monkeypatch.setattr(draw_handler, "_sensor_visible", lambda _context, name: visible[name])
    return SimpleNamespace(card=card, space=space, look=look, visible=visible)


def redraw():
    draw_handler.draw()
    draw_handler.draw_text()


def test_nothing_is_read_cast_or_worked_out_while_drawing(window, rig, monkeypatch):
    scenes.drawn(rig)
    forbidden = "while drawing"
    for owner, name in (
        *(
            (document, each)
            for each in ("sensor_from_object", "vehicle_from_collection", "pose_of")
        ),
        *((document, each) for each in ("prior_from_scene", "sensor_objects")),
        *((pe.Vehicle, each) for each in ("first_hit", "seen_from")),
        *((sight.Sight, each) for each in ("ground", "blind", "reach")),
        (vehicle_cache.shared, "read"),
        (graphics, "cast"),
        (engine_process, "ask"),
        (scheduler, "update"),
    ):
        monkeypatch.setattr(owner, name, lambda *_, **__: pytest.fail(forbidden))
    sheet = shown_of(rig.name, "ground")[""].shape.sheet
    assert "mesh" in vars(sheet), "its triangles would be made by the first redraw"
    rig.objects["roof"].location.x += 0.5  # even when the scene has moved on
    redraw()
    assert len(window.card.drawn) == 14 and "roof" in window.card.written


def test_shapes_are_uploaded_once(window, rig):
    scenes.drawn(rig)
    for _ in range(3):
        redraw()
    assert window.card.uploaded == 14 and len(window.card.drawn) == 42
    rig.objects["eye"].location.z += 0.1
    bpy.context.view_layer.update()
    scenes.drawn(rig)
    redraw()
    # its frustum and name; map, blind ground, its view from above, reach, requirements, scenario
    assert window.card.uploaded == 14 + 8
    rig.perception_entropy.view.show_ground = False
    scenes.drawn(rig)
    redraw()
    assert len(window.card.drawn) == 42 + 14 + 13


def test_simple_has_its_words_on_legends_too(window, rig):
    """The read-out says "Score" there, and no nats."""
    scenes.drawn(rig)
    for panels, words in (("ALL", "Entropy nats"), ("SIMPLE", "Score")):
        rig.perception_entropy.panels = panels
        window.card.written = []
        redraw()
        (title,) = (t for t in window.card.written if t.startswith(("Entropy,", "Score,")))
        in_nats = " nats" * any("nats" in text for text in window.card.written)
        assert title.partition(",")[0] + in_nats == words


def test_overlays_off_hides_all(window, rig):
    scenes.drawn(rig)
    window.space.overlay.show_overlays = False
    redraw()
    assert not window.card.drawn and not window.card.written
