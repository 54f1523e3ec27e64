"""Requests live scores: of each move, and once the scene is idle.

A request is read inside Blender's own update, which costs a fraction of a millisecond, and scored
by the engine's process at once, while Blender draws; only the latest request waits. The score is
stored between two redraws: panel and read-out show the same one.
"""

from functools import partial

import bpy

from .. import document, signals
from ..caches import change_events, sensor_cache, vehicle_cache
from ..choices import BEFORE_MOVE
from ..engine import pe
from ..processes import engine_calls, engine_process
from ..processes.engine_calls import Problem, ScoreRequest, rig_key
from ..view import viewport
from . import background_figures
from .state import Baseline, LiveScore, LiveState, live_state, states

VEHICLE_MOVES = "The vehicle is moving: scored again when it stops"
MOVING = "TRANSFORM_OT_"
"""How the names of Blender's operators begin that move things."""
MOVE_LABEL = "before this move"


def follow_update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """After an update: request a score where a sensor has moved."""
    if bpy.app.background or not scene.perception_entropy.live.on:
        return
    state = live_state(scene.name)
    last = state.last_read
    if last is None or last.changes == change_events.change_count():
        return
    if last.vehicle_version != vehicle_cache.shared.version:
        state.next_request()
        state.moving = True
        viewport.redraw_editors()
        if operator := _moving_operator():  # the vehicle is dragged; an undo is no move
            note_move(state, operator, None)
            state.note = VEHICLE_MOVES
        return
    state.moving = True
    viewport.redraw_editors()  # of the sidebar, too: it shows the same as the view
    request_score(scene, depsgraph, moving=True)


def on_restored(*_: object) -> None:
    """After undo or redo: the scores are of another scene than the one that came back."""
    for name, state in states.items():
        cancel(name)
        state.next_request()
        state.score = state.exact = None
        state.moving = False
        state.note = ""


def on_idle() -> None:
    """Request the exact score of every scene that is shown: nothing moves any more."""
    is_held = bool(_moving_operator())
    for state in list(states.values()):
        state.moving = False
        if not is_held:
            state.operator = 0  # what moves next is another move
    for scene in shown_scenes():
        depsgraph = document.view_layer_of(scene).depsgraph
        if depsgraph is not None:
            request_score(scene, depsgraph, moving=False)


def request_score(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, *, moving: bool) -> None:
    """Read a scene, and have it scored."""
    name = scene.name
    state = live_state(scene.name)
    number = state.next_request()
    try:
        request = read_request(scene, depsgraph)
    except pe.InputError as error:
        show_note(name, str(error))
        return
    if moving:
        note_move(state, _moving_operator(), request.rig)
    if state.last_read is not None and state.last_read.prior_key != request.prior_key:
        state.before_move = None  # entropies under two priors cannot be compared
    state.last_read = request
    baseline = baseline_of(scene, request, moving)
    needed = None if baseline is None or moving or baseline.summary else baseline.rig
    deliver = partial(take_score, name, request, number=number, baseline=baseline, moving=moving)
    fail = partial(report_failure, name)
    topic = engine_process.LIVE_SCORE + name
    given = (name, request, needed)
    lane = engine_process.FOLLOWS_MOUSE
    engine_process.ask(topic, engine_calls.live_score, given, deliver, fail=fail, lane=lane)
    if not moving:
        background_figures.request(scene, request, baseline)


def read_request(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> ScoreRequest:
    """Read what the score needs of a scene; the vehicle only if it has changed. `InputError` when
    something in the scene is wrong: one line."""
    document.check_scene(scene)
    rig = document.rig_from_objects(sensor_cache.sensors(scene), depsgraph)
    state = live_state(scene.name)
    prior_key = document.prior_key(scene)
    if state.prior is None or state.prior[0] != prior_key:
        state.prior = prior_key, document.prior_from_scene(scene)
    prior = state.prior[1]
    vehicle, vehicle_key = vehicle_cache.shared.read(scene, depsgraph)
    if vehicle is None:
        collection = scene.perception_entropy.vehicle
        vehicle = document.vehicle_from_collection(collection, depsgraph)  # raises the reason
    settings = scene.perception_entropy
    scored = document.document_of(settings, *document.SCORED_PARTS)
    space = scored.space
    model = scored.perception
    targets = scored.targets
    problem_key = prior_key, vehicle_key, space, model, targets
    problem = Problem(problem_key, prior, vehicle, space, model=model, targets=targets)
    return ScoreRequest(
        problem,
        rig,
        (prior_key, space, model, targets),
        changes=change_events.change_count(),
        vehicle_version=vehicle_cache.shared.version,
    )


def take_score(
    name: str,
    request: ScoreRequest,
    scores: tuple[pe.Score, pe.Score | None],
    *,
    number: int,
    baseline: Baseline | None,
    moving: bool,
) -> None:
    """Store a score that the engine made, and have it drawn."""
    summary, before = scores
    if baseline is not None and before is not None:
        baseline.summary = before
    live_state(name).put(LiveScore(summary, baseline, not moving, request, number=number))
    signals.live_score_changed.emit()


def report_failure(name: str, error: Exception) -> None:
    """Show why there is no score; let Blender report our own mistakes as well."""
    show_note(name, str(error) if isinstance(error, pe.InputError) else f"Not scored: {error!r}")
    if not isinstance(error, (pe.InputError, MemoryError)):
        raise error


def show_note(name: str, line: str) -> None:
    """Show why there is no newer score."""
    cancel(name)
    live_state(name).note = line
    signals.live_score_changed.emit()


def cancel(name: str) -> None:
    """Drop the request of a scene; one that is in progress will not be shown."""
    engine_process.drop(engine_process.LIVE_SCORE + name)


def on_toggled() -> None:
    """Begin in scenes where *Live* is on, drop everything in those where it is off."""
    for scene in bpy.data.scenes:
        if not scene.perception_entropy.live.on:
            cancel(scene.name)
            background_figures.cancel(scene.name)
            live_state(scene.name).switch_off()
    if not bpy.app.background:
        on_idle()
    signals.live_score_changed.emit()


def shown_scenes() -> list[bpy.types.Scene]:
    """Return the scenes that a window shows and whose *Live* is on."""
    windows = (w for manager in bpy.data.window_managers for w in manager.windows)
    shown = {window.scene.name: window.scene for window in windows}
    return [scene for scene in shown.values() if scene.perception_entropy.live.on]


def clear(*_: object) -> None:
    """Drop everything before another file is opened: nothing of this one is kept or delivered."""
    for name in tuple(states):
        cancel(name)
    background_figures.clear()
    states.clear()


def _moving_operator() -> int:
    """Return a number of the operator that moves things with the mouse; 0 when there is none."""
    windows = (w for manager in bpy.data.window_managers for w in manager.windows)
    running = (each for window in windows for each in window.modal_operators)
    return next((o.as_pointer() for o in running if o.bl_idname.startswith(MOVING)), 0)


def unregister() -> None:
    """Drop everything."""
    clear()


def note_move(state: LiveState, operator: int, now: pe.Rig | None) -> None:
    """Note an update in which something moves; keep what was there before where a move begins.
    `state` is as it was before this update. `operator` is the number of the one that moves with the
    mouse; 0 when there is none. `now` is None when it is the vehicle that moves."""
    if state.operator and operator in (0, state.operator):
        state.operator = operator
        return
    last = state.last_read
    if last is None or (now is not None and rig_key(now) == rig_key(last.rig)):
        return
    state.operator = operator
    exact = state.exact
    summary = None
    if exact and _is_same(exact.request, last):
        summary = exact.summary
    if operator or summary is not None:  # otherwise a field is dragged, or typed in several times
        rig = None if now is None else last.rig
        state.before_move = Baseline(MOVE_LABEL, rig, summary)


def _is_same(one: ScoreRequest, other: ScoreRequest) -> bool:
    same_problem = one.problem.key == other.problem.key
    return same_problem and rig_key(one.rig) == rig_key(other.rig)


def baseline_of(scene: bpy.types.Scene, request: ScoreRequest, moving: bool) -> Baseline | None:
    """Return what a scene is compared with, as its settings choose; None where nothing is yet. A
    variant is read again whenever the scene is idle; while sensors move it stays what it was."""
    state = live_state(scene.name)
    choice = scene.perception_entropy.live.against
    chosen = state.chosen
    if chosen is not None and moving and chosen[0][:2] == (choice, request.problem.key):
        return chosen[1]
    rig_and_label = _chosen_rig(scene, choice)
    if rig_and_label is None:
        state.chosen = None
        return state.before_move
    rig, label = rig_and_label
    key = choice, request.problem.key, rig_key(rig), label
    if chosen is None or chosen[0] != key:
        chosen = state.chosen = key, Baseline(label, rig)
    return chosen[1]


def _chosen_rig(scene: bpy.types.Scene, choice: int) -> tuple[pe.Rig, str] | None:
    """Return the rig to compare with and its label; None where the last move decides."""
    for row in scene.perception_entropy.variants if choice != BEFORE_MOVE else ():
        if row.key == choice:
            try:
                returns = scene.perception_entropy.returns
                return document.rig_of(document.records_of(row), returns=returns), row.name
            except pe.InputError:  # no sensor of it counts, or a model is not known here
                return None
    return None
