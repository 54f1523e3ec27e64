"""The live score: exact while the hand moves and once it rests, and nothing left behind."""

import json
from dataclasses import replace

import bpy
import pytest

from blender_addon import document
from blender_addon.caches import change_events, result_staleness
from blender_addon.live import (
    AT_REST,
    MOVING,
    OUT_OF_DATE,
    PENDING,
    STORED,
    readout,
    readout_text,
    session,
    shown_score,
    state,
)
from blender_addon.overlay import snapshot
from blender_addon.panels import main
from blender_addon.panels.dashboard import HEADS
from blender_addon.processes import engine_calls, engine_process
from pe_core.sensors.kernels import DefinedSample
from tests.addon import layouts, scenes

SAMPLES = 4096


class Window:
    """Blender's own as motion and session see it, with a window and no clock."""

    data = bpy.data
    types = bpy.types

    class app:
        background = False
        handlers = bpy.app.handlers

        class timers:
            is_registered = staticmethod(lambda _: True)
            unregister = staticmethod(lambda _: None)


@pytest.fixture
def live(monkeypatch, car):
    """The car with a second sensor, in a window, the live score switched on."""
    scenes.add_sensor("front", model="Camera 60 deg", location=(1.9, 0.0, 1.2))
    monkeypatch.setattr(engine_calls, "SAMPLES", SAMPLES)
    for module in (change_events, session):
        monkeypatch.setattr(module, "bpy", Window)
    drag(car.objects["roof"])  # from here on it is known what there is
    car.perception_entropy.live.figures = False  # but where they are tested
    car.perception_entropy.live.on = True
    return car


def drag(obj, by=0.05):
    obj.location.x += by
    bpy.context.view_layer.update()


def rest():
    session.on_idle()


def reading(scene):
    return state.live_state(scene.name).score


def is_exact(scene):
    return state.live_state(scene.name).is_current(reading(scene))


def exact():
    """The score of the scene's study on as many voxels, by an evaluator of its own."""
    study = replace(scenes.study(), samples=SAMPLES)
    return study.evaluator().score(study.rig)


def told(summary):
    return {name: getattr(summary, name) for name in ("entropy", "coverage", "stderr", "per_zone")}


def test_a_drag_is_exact_and_compared_with_where_it_began(live, monkeypatch):
    """The scenario of two moves: every score is that of a study, to the bit."""
    roof = live.objects["roof"]
    start = reading(live).summary
    assert told(start) == told(exact()) and reading(live).exact and reading(live).before is None
    for _ in range(3):
        drag(roof)
        assert told(reading(live).summary) == told(exact()) and not reading(live).exact
        assert reading(live).request.rig["roof"].pose == scenes.study().rig["roof"].pose
        assert reading(live).before == start
    rest()
    second = reading(live).summary
    assert told(second) == told(exact()) != told(start)
    assert is_exact(live) and reading(live).before == start
    roof.update_tag()  # an update that moves nothing begins no move
    bpy.context.view_layer.update()
    for _ in range(2):
        drag(roof)
        assert reading(live).before == second
    rest()
    monkeypatch.setattr(engine_process, "ask", lambda *_, **__: None)  # a machine that is busy
    drag(roof)
    assert reading(live).exact and not is_exact(live), "of before the move"
    rest()
    assert not is_exact(live), "asked for, not there yet"


def test_a_variant_is_what_it_is_compared_with(live):
    start = exact()
    bpy.ops.pe.save_variant()
    row = live.perception_entropy.variants[0]
    drag(live.objects["roof"], 0.3)
    live.perception_entropy.live.reference = str(row.key)
    assert told(reading(live).before) == told(start)
    assert reading(live).baseline.label == row.name
    bpy.ops.pe.update_variant()
    rest()
    assert told(reading(live).before) == told(exact()) != told(start)
    bpy.ops.pe.remove_row(rows="variants")
    rest()
    assert reading(live).baseline is None or reading(live).baseline.label != "Variant"


def test_only_what_moved_is_measured_and_the_vehicle_is_not_read(live, monkeypatch):
    for of, name in (
        (DefinedSample, "measure"),  # of cameras
        (document, "vehicle_from_collection"),
        (engine_calls, "make_evaluator"),
    ):
        monkeypatch.setattr(of, name, lambda *_, name=name: pytest.fail(f"{name} again"))
    before = reading(live)
    drag(live.objects["roof"])
    rest()
    assert is_exact(live) and reading(live).summary != before.summary


def test_a_vehicle_that_moves_is_read_once_it_rests(live, monkeypatch):
    before = reading(live)
    with monkeypatch.context() as while_it_moves:
        read = "vehicle_from_collection"
        while_it_moves.setattr(document, read, lambda *_: pytest.fail("read while it moves"))
        drag(live.objects["cabin"])
        assert state.live_state(live.name).note == "", "a step of undo or a script moves nothing"
        assert not is_exact(live)
        while_it_moves.setattr(session, "_moving_operator", lambda: 1)
        drag(live.objects["cabin"])
        assert state.live_state(live.name).note == session.VEHICLE_MOVES
    rest()
    assert state.live_state(live.name).note == "" and reading(live).summary != before.summary
    assert told(reading(live).summary) == told(exact())


def test_what_is_wrong_is_said_in_a_line_until_it_is_mended(live):
    roof = live.objects["roof"]
    roof.scale = (2.0, 2.0, 2.0)
    bpy.context.view_layer.update()
    assert state.live_state(live.name).note.startswith("scene: sensor 'roof': scale: expected 1")
    rest()
    assert "\n" not in state.live_state(live.name).note
    roof.scale = (1.0, 1.0, 1.0)
    bpy.context.view_layer.update()
    rest()
    assert state.live_state(live.name).note == "" and told(reading(live).summary) == told(exact())


def test_a_mistake_of_ours_is_shown_and_told(live, monkeypatch):
    def broken(*_):
        raise ValueError("odd")

    monkeypatch.setattr(engine_calls, "live_score", broken)
    with pytest.raises(ValueError, match="odd"):
        rest()
    assert state.live_state(live.name).note == "Not scored: ValueError('odd')"


def test_without_a_window_nothing_follows(car):
    car.perception_entropy.live.on = True
    drag(car.objects["roof"])
    assert reading(car) is None


def both(scene):
    """What panel and read-out say: entropies, and whether these are of a scene at rest."""
    shown = shown_score(scene)
    text = readout_text.readout_of(shown)
    drawn = layouts.drawn(main.main, **vars(layouts.Window(scene, scene.objects["roof"])))
    labels = drawn.texts("label")
    now = f"{shown.entropy:.3f}"
    before = shown.before("entropy")
    assert now in labels and text.headline.startswith(now)
    assert HEADS[shown.phase][0] in " ".join(labels)
    assert shown.phase in readout_text.state_of(shown)
    assert (before is not None and f"({before:.3f})" in labels) == bool(text.sense)
    if shown.label:
        scene.perception_entropy.view.ground_difference = True
        depsgraph = bpy.context.evaluated_depsgraph_get()
        request = snapshot.SnapshotReader().request(scene, depsgraph, moving=False)
        assert request.compared_name == shown.label
    return text, shown


def read_everywhere(scene):
    """The score, its state and its change, each read where it is drawn: in the read-out, and in the
    dashboard of the panel, in *Simple* and in *All*. They have to be one."""
    rows = readout.rows_of(shown_score(scene))
    words = [text for row in rows[:2] for text, _ in row.words]
    nats, *change = words[: len(rows[0].words)]
    phase = next(phase for phase in HEADS if any(text.endswith(phase) for text in words))
    for panels in ("SIMPLE", "ALL"):
        scene.perception_entropy.panels = panels
        window = layouts.Window(scene, scene.objects["roof"])
        labels = layouts.drawn(main.main, **vars(window)).texts("label")
        scores = [text for text in labels if text in (nats, nats.removesuffix(" nats"))]
        known = tuple(head for head, _ in HEADS.values())
        heads = [text for text in labels if text.startswith(known)]
        assert len(scores) == 1, "one number"
        assert [text.partition(": 4")[0] for text in heads] == [HEADS[phase][0]], "one state"
    is_told = bool(change) and change[0][-6:] in ("better", " worse")
    before = shown_score(scene).before("entropy")
    assert is_told == (before is not None and f"({before:.3f})" in labels), "one change"
    return float(nats.split()[0]), phase, is_told


def test_one_number_and_one_state_are_read_in_a_drag_after_undo_and_after_esc(live, monkeypatch):
    live.perception_entropy.live.figures = True
    bpy.ops.pe.score()
    rest()
    scored = live.perception_entropy.result.entropy
    bpy.ops.ed.undo_push(message="scored")
    assert read_everywhere(live) == (round(scored, 3), STORED, False)
    start = tuple(live.objects["roof"].location)
    with monkeypatch.context() as hand:
        hand.setattr(session, "_moving_operator", lambda: 7)
        for _ in range(2):
            drag(live.objects["roof"], 8.0)
            entropy = reading(live).summary.entropy
            assert read_everywhere(live) == (round(entropy, 3), MOVING, True)
        live.objects["roof"].location = start  # Esc: the operator takes it back
        bpy.context.view_layer.update()
        assert read_everywhere(live)[2] is False, "where it began nothing has changed"
    result_staleness.update_result()
    rest()
    assert read_everywhere(live) == (round(scored, 3), STORED, False)
    drag(live.objects["roof"], 8.0)
    live.perception_entropy.result_stale = True
    rest()
    entropy = reading(live).summary.entropy
    assert read_everywhere(live) == (round(entropy, 3), AT_REST, True)
    bpy.ops.ed.undo_push(message="moved")
    bpy.ops.ed.undo()
    scene = bpy.context.scene
    assert read_everywhere(scene) == (round(scored, 3), STORED, False)
    bpy.ops.ed.redo()
    scene = bpy.context.scene
    assert read_everywhere(scene)[1] == OUT_OF_DATE
    rest()
    assert read_everywhere(scene)[:2] == (round(entropy, 3), AT_REST)


def test_panel_and_read_out_say_the_same_in_a_drag_after_undo_and_after_a_search(live, monkeypatch):
    """After a search and Esc its gain stood above zones of the drag before it."""
    settings = live.perception_entropy
    bpy.ops.pe.score()
    rest()
    assert both(live)[1].phase == STORED and both(live)[0].against == ""
    drag(live.objects["roof"], 0.6)
    monkeypatch.setattr(engine_process, "ask", lambda *_, **__: None)  # a machine that is busy
    assert both(live)[1].phase == MOVING and both(live)[0].against
    result_staleness.update_result()
    rest()
    assert both(live)[1].phase == PENDING
    monkeypatch.undo()
    monkeypatch.setattr(engine_calls, "SAMPLES", SAMPLES)
    for module in (change_events, session):
        monkeypatch.setattr(module, "bpy", Window)
    rest()
    text, shown = both(live)
    assert (shown.phase, text.against) == (AT_REST, "compared with before this move")
    assert shown.before("entropy") == shown.pair[0].entropy != shown.entropy

    bpy.ops.pe.score()
    rest()
    data = json.loads(settings.result_json)
    data["before"] = {**data["before"], "entropy": data["entropy"] + 0.25}
    settings.result_json = json.dumps({**data, "kind": "optimize"})
    text, shown = both(live)
    assert (text.change, text.against) == ("0.250 better", "compared with before the search")
    assert not [line for line in text.lines if line[0].text.startswith(("Better", "Worse"))]
    assert bpy.ops.pe.save_variant() == {"FINISHED"}
    settings.live.reference = str(settings.variants[0].key)
    assert both(live)[0].against == f"compared with {settings.variants[0].name}"
