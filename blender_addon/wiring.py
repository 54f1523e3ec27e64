"""What is called when: one table for Blender's events, one for the add-on's signals.

Blender has one handler of ours for each event, and each handler calls the functions of its row in
the order that is written here. Caches are invalidated first, as what follows reads them; changes
are counted before the live score, which compares the counts, follows them.
"""

import traceback
from collections.abc import Callable

import bpy
from bpy.app.handlers import persistent

from . import document, signals
from .caches import change_events, consistency, result_staleness, sensor_cache, vehicle_cache
from .live import session
from .operators import camera_pictures, look_through, upright
from .overlay import draw_handler, scheduler
from .processes import engine_process
from .queries import body_query, diagnostics, location_query, where_map
from .view import housing, variant_pictures, viewport

Function = Callable[..., None]

AFTER_STEP = (
    sensor_cache.invalidate,
    vehicle_cache.shared.invalidate,
    session.on_restored,
    body_query.schedule,
    change_events.note_change,
)
"""After a step of undo or redo: any object may be another one."""
EVENTS: dict[str, tuple[Function, ...]] = {
    "depsgraph_update_post": (
        sensor_cache.invalidate,
        vehicle_cache.invalidate_if_updated,
        camera_pictures.note_change,
        change_events.note_if_changed,
        session.follow_update,
        body_query.note_update,
        scheduler.note_selection,
    ),
    "frame_change_post": (vehicle_cache.invalidate_if_updated, change_events.note_if_changed),
    "undo_pre": (sensor_cache.invalidate,),
    "undo_post": AFTER_STEP,
    "redo_pre": (sensor_cache.invalidate,),
    "redo_post": AFTER_STEP,
    "load_pre": (
        sensor_cache.invalidate,
        vehicle_cache.shared.clear,
        change_events.clear,
        session.clear,
        diagnostics.clear,
        result_staleness.clear,
        location_query.clear,
        body_query.clear,
        where_map.clear,
        variant_pictures.clear,
        scheduler.clear,
        engine_process.stop,
    ),
    "load_post": (
        sensor_cache.invalidate,
        vehicle_cache.shared.clear,
        engine_process.begin,
        consistency.after_load,
        change_events.note_change,
        draw_handler.clear,
        body_query.schedule,
        scheduler.clear,
        scheduler.schedule,
    ),
    "save_pre": (consistency.before_save,),
}
"""By the name of the event in `bpy.app.handlers`."""

LISTENERS: tuple[tuple[signals.Signal, tuple[signals.Listener, ...]], ...] = (
    (
        signals.study_changed,
        (
            sensor_cache.invalidate,
            document.sync_own_sensors,
            change_events.note_change,
            body_query.schedule,
            scheduler.schedule,
            housing.update_housings,
        ),
    ),
    (signals.view_changed, (scheduler.schedule, viewport.redraw_editors)),
    (
        signals.moving,
        (
            look_through.restore_lost,
            upright.on_moving,
            consistency.repair_scenes,
            diagnostics.postpone_checks,
            body_query.schedule,
            scheduler.on_moving,
        ),
    ),
    (
        signals.idle,
        (
            look_through.restore_lost,
            result_staleness.update_result,
            result_staleness.update_variants,
            session.on_idle,
            diagnostics.schedule_checks,
            location_query.query_again,
            body_query.schedule,
            where_map.discard_outdated,
            scheduler.on_idle,
        ),
    ),
    (signals.live_toggled, (session.on_toggled,)),
    (signals.live_score_changed, (viewport.redraw_editors, scheduler.on_live_score)),
)


def _handler(event: str) -> Function:
    """Return the handler of an event. As with handlers of Blender's own, an error in one function
    does not keep the others from being called."""

    def handle(*args: object) -> None:
        for function in EVENTS[event]:
            try:
                function(*args)
            except Exception:
                traceback.print_exc()

    handle.__name__ = f"on_{event}"
    persistent(handle)
    return handle


HANDLERS = {event: _handler(event) for event in EVENTS}


def register() -> None:
    """Add the handlers, and connect the listeners in their order."""
    for event, handler in HANDLERS.items():
        getattr(bpy.app.handlers, event).append(handler)
    for signal, listeners in LISTENERS:
        for listener in listeners:
            signal.connect(listener)
    change_events.note_change()  # switched on again: what is there has not been read


def unregister() -> None:
    """Remove the handlers, and disconnect the listeners."""
    for signal, listeners in LISTENERS:
        for listener in listeners:
            signal.disconnect(listener)
    for event, handler in HANDLERS.items():
        getattr(bpy.app.handlers, event).remove(handler)
