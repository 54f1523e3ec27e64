"""What is shown follows the scene: worked out once a change, and never while drawing."""

import bpy
import numpy as np
import pytest

from blender_addon import document, signals
from blender_addon.engine import graphics, sight
from blender_addon.live import state
from blender_addon.overlay import draw_handler, ground_layers, layers, scheduler
from blender_addon.overlay.layer_cache import shown, shown_of
from blender_addon.processes import analysis_calls, engine_process
from tests.addon import scenes
from tests.thorough import pairs

ON_REQUEST = {"front", "ghosts", "place", "region", "steepest", "where"}
"""Layers of what was asked for, another variant, a place (see test_annotations), the best way of a
sensor (see test_steepest_way), and of a vehicle without sensors (see test_first_steps)."""
ALL_LAYERS = {layer.name for layer in layers.LAYERS} - ON_REQUEST


@pytest.fixture
def rig(car):
    """The car with a LiDAR on its roof and a camera at its front, all layers on."""
    return scenes.seen_rig(car)


@pytest.fixture
def worked(monkeypatch):
    """Return the layers and sensors that are worked out, as they come."""
    done = []

    def watched(layer):
        def shape(request, cache, name):
            done.append((layer.name, name))
            return layer.shape(request, cache, name)

        return layer.__class__(
            layer.name, layer.label, layer.keys, shape, layer.line_px, layer.rough
        )

    monkeypatch.setattr(analysis_calls, "LAYERS", tuple(map(watched, layers.LAYERS)))
    return done


def test_every_layer_shows_something_of_a_rig(rig):
    drawn = scenes.drawn(rig)
    assert set(drawn) == ALL_LAYERS
    assert set(drawn["labels"]) == {"roof", "eye"}
    assert set(drawn["beams"]) == {"roof"} and set(drawn["frustums"]) == {"eye"}
    for name in ("ground", "blind", "reach", "heat"):
        assert set(drawn[name]) == {layers.WHOLE_RIG}
    for shapes in drawn.values():
        for item in shapes.values():
            shape = getattr(item.at(0.0), "over", item.at(0.0))  # what a plate has over pictures
            parts = (shape.lines, shape.faces, shape.through, shape.thin)
            assert shape.labels or shape.sheet or any(len(part.points) for part in parts)
            assert all(p.points.flags.c_contiguous and p.colors.flags.c_contiguous for p in parts)


def test_each_layer_has_a_switch_and_all_of_them_one(rig):
    view = rig.perception_entropy.view
    for name in ALL_LAYERS:
        setattr(view, f"show_{name}", False)
        assert set(scenes.drawn(rig)) == ALL_LAYERS - {name}
        setattr(view, f"show_{name}", True)
    rig.perception_entropy.show_overlay = False
    assert not scenes.drawn(rig)
    rig.perception_entropy.show_overlay = True
    assert set(scenes.drawn(rig)) == ALL_LAYERS


def test_what_is_ready_is_taken_before_anything_is_drawn(rig, monkeypatch):
    """Also where this view shows no overlay: later Blender drops the tag for another redraw."""
    taken = []
    monkeypatch.setattr(engine_process, "deliver_for_view", lambda: taken.append(True))
    rig.perception_entropy.show_overlay = False
    draw_handler.draw()
    assert taken


def test_nothing_is_worked_out_without_a_change(rig, worked):
    scenes.drawn(rig)
    assert len(worked) == 14
    before = {layer: dict(shown_of(rig.name, layer)) for layer in ALL_LAYERS}
    worked.clear()
    scenes.drawn(rig)
    scheduler.update(moving=True)
    scheduler.update()
    assert not worked
    for layer, items in before.items():
        assert all(shown_of(rig.name, layer)[name].shape is i.shape for name, i in items.items())


def test_a_moved_sensor_is_worked_out_alone_and_the_vehicle_is_not_read(rig, worked, monkeypatch):
    scenes.drawn(rig)
    worked.clear()
    monkeypatch.setattr(document, "vehicle_from_collection", lambda *_: pytest.fail("read again"))
    rig.objects["eye"].location.z += 0.1
    bpy.context.view_layer.update()
    scenes.drawn(rig)
    of_the_rig = {("ground", ""), ("blind", ""), ("reach", ""), ("requirements", "")}
    of_the_rig |= {("scenario", ""), ("birds_eye", "")}
    assert set(worked) == {("frustums", "eye"), ("labels", "eye"), *of_the_rig}


def test_what_is_shown_of_before_a_change_is_marked_until_it_is_worked_out(rig, monkeypatch):
    scenes.drawn(rig)
    item = shown_of(rig.name, "blind")[""]
    assert not scheduler.is_preview(rig.name, "blind", "", item)
    monkeypatch.setattr(scheduler.engine_process, "ask", lambda *_, **_named: None)  # it is busy
    rig.objects["roof"].location.x += 0.1
    bpy.context.view_layer.update()
    scheduler.on_idle()
    assert shown_of(rig.name, "blind")[""] is item
    assert draw_handler.legend_of(rig.name, "blind", "").title.endswith(" (preview)")


def test_while_something_moves_it_is_rough_and_fine_at_rest(rig, worked):
    scenes.drawn(rig)
    fine = shown_of(rig.name, "ground")[""].shape.sheet.image.shape
    rig.objects["roof"].location.x += 0.1
    bpy.context.view_layer.update()
    scheduler.on_moving()
    item = shown_of(rig.name, "ground")[""]
    assert item.rough and item.shape.sheet.image.shape < fine
    title = item.shape.legend.title
    assert draw_handler.legend_of(rig.name, "ground", "").title == f"{title} (preview)"
    worked.clear()
    scheduler.on_idle()
    assert draw_handler.legend_of(rig.name, "ground", "").title == title
    assert not shown_of(rig.name, "ground")[""].rough
    assert shown_of(rig.name, "ground")[""].shape.sheet.image.shape == fine
    rough = {layer.name for layer in layers.LAYERS if layer.rough}
    assert {name for name, _ in worked} == rough - ON_REQUEST


def test_settings_count(rig):
    view = rig.perception_entropy.view
    view.channels = "ALL"
    view.beam_limit = 100
    view.rings = False
    assert len(scenes.drawn(rig)["beams"]["roof"].lines.points) <= 100 * 4
    rig.objects["roof"].perception_entropy.show = False
    drawn = scenes.drawn(rig)
    assert "beams" not in drawn and set(drawn["labels"]) == {"eye"}
    assert "ground" in drawn, "it is scored all the same"
    rig.objects["eye"].perception_entropy.model = "no such model"
    assert "frustums" not in scenes.drawn(rig)


@pytest.mark.parametrize(
    ("height", "quantity"),
    pairs(["AVERAGE", "H0", "H50", "H100", "H150"], ["ENTROPY", "COVERAGE", "SENSORS"]),
)
def test_the_map_is_that_of_the_engine(rig, quantity, height):
    view = rig.perception_entropy.view
    show_alone(view, "ground")
    view.ground_quantity = quantity
    view.ground_height = height
    view.ground_opacity = 1.0
    sheet = scenes.drawn(rig)["ground"][""].sheet
    study = scenes.study()
    metres = None if height == "AVERAGE" else int(height[1:]) / 100.0
    look = sight.Sight(study.space, study.prior, study.vehicle)
    found = look.ground(study.rig, metres, ground_layers.FINE_M)
    bounds = None if quantity == "SENSORS" else graphics.fitted_bounds(found, quantity)
    expected = graphics.ground_map(found, quantity, 1.0, faded=True, bounds=bounds).sheet
    np.testing.assert_allclose(sheet.image, expected.image, atol=1e-6)


def test_after_a_score_its_own_map_is_shown_until_something_moves(rig):
    rig.perception_entropy.score_samples = 0
    rig.perception_entropy.view.ground_range = "WHOLE"
    assert bpy.ops.pe.score() == {"FINISHED"}
    shape = scenes.drawn(rig)["ground"][""]
    score = state.live_state(rig.name).finished.score
    expected = score.ground_map.coarser(5).entropy
    np.testing.assert_array_equal(shape.sheet.image[..., 3] == 0.0, np.isnan(expected).T)
    lowest = np.nanargmin(expected)
    highest = np.nanargmax(expected)
    rgb = shape.sheet.image[..., :3].transpose(1, 0, 2).reshape(-1, 3)
    quantity = graphics.QUANTITIES["ENTROPY"]
    for place in (lowest, highest):
        value = expected.ravel()[place]
        np.testing.assert_allclose(rgb[place], quantity.colors(value), atol=1e-6)
    assert "as scored" in shape.legend.title
    rig.objects["roof"].location.z += 0.1
    bpy.context.view_layer.update()
    assert "as scored" not in scenes.drawn(rig)["ground"][""].legend.title


def show_alone(view, layer):
    """Switch all layers off but one."""
    for name in ALL_LAYERS:
        setattr(view, f"show_{name}", name == layer)


def test_changes_are_heard_and_another_file_forgets(rig):
    assert {scheduler.on_moving} <= set(signals.moving.listeners)
    assert {scheduler.on_idle} <= set(signals.idle.listeners)
    scenes.drawn(rig)
    assert len(shown) > 5
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    assert len(shown) == 0


@pytest.mark.parametrize("quantity", ["ENTROPY", "COVERAGE"])
def test_the_map_keeps_its_scale_from_the_first_score_until_it_is_fitted_again(rig, quantity):
    def ends():
        scenes.drawn(rig)
        return shown_of(rig.name, "ground")[""].shape.legend.bounds

    rig.perception_entropy.view.ground_quantity = quantity
    bpy.ops.pe.score()
    first = ends()
    for place in ((0.0, 0.0, 0.7), (1.9, 0.0, 1.3)):
        rig.objects["roof"].location = place
        bpy.context.view_layer.update()
        assert ends() == first, "what was not scored yet"
        bpy.ops.pe.score()
        assert ends() == first
    assert bpy.ops.pe.fit_colors() == {"FINISHED"}
    again = ends()
    assert again != first
    rig.objects["roof"].location = (-0.43, 0.0, 1.8)
    bpy.context.view_layer.update()
    bpy.ops.pe.score()
    assert ends() == again
