"""States and weathers in the panel: add, remove, show a state, read the states' motions again."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, IntProperty

from .. import bridge, signals
from ..choices import free_name
from ..engine import pe
from .list_rows import RemoveRow
from .reports import USER_ERRORS, OperatorResult, report, report_error

DRAWN = -1
WEATHERS = (
    ("CLEAR", "Clear Air", "Sensors as they are"),
    ("RAIN", "Rain", "25 mm/h: heavy rain"),
    ("SNOW", "Snow", "2.5 mm/h of water"),
    ("FOG", "Fog", "A visibility of 100 m"),
    ("NIGHT", "Night", "Cameras see what headlamps light"),
)
STARTS = {"RAIN": ("rain_mm_h", 25.0), "SNOW": ("snow_mm_h", 2.5), "FOG": ("fog_mor_m", 100.0)}


class PE_OT_add_state(bpy.types.Operator):
    """Add the frame that is shown as a state of the vehicle; what has moved is read here"""

    bl_idname = "pe.add_state"
    bl_label = "Add State of This Frame"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene = context.scene
        settings = scene.perception_entropy
        row = settings.states.add()
        is_drawn = scene.frame_current == settings.drawn_frame
        names = {other.name for other in settings.states}
        row.name = free_name("As Drawn" if is_drawn else f"Frame {scene.frame_current}", names)
        row.frame = scene.frame_current
        try:
            bridge.read_states(scene)
        except USER_ERRORS as error:
            settings.states.remove(len(settings.states) - 1)
            return report_error(self, error)
        settings.state_index = len(settings.states) - 1
        signals.study_changed.emit()
        report(self, "INFO", f"Added state {row.name}")
        return {"FINISHED"}


class PE_OT_read_states(bpy.types.Operator):
    """Read what moves in all states again: the animation has changed"""

    bl_idname = "pe.read_states"
    bl_label = "Read States Again"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        try:
            changed = bridge.read_states(context.scene)
        except USER_ERRORS as error:
            return report_error(self, error)
        text = f"States changed: {', '.join(changed)}" if changed else "No state has changed"
        report(self, "INFO", text)
        return {"FINISHED"}


class PE_OT_show_state(bpy.types.Operator):
    """Show this state in the 3D view; live score and maps are those of what is shown"""

    bl_idname = "pe.show_state"
    bl_label = "Show State"
    bl_options = {"REGISTER", "UNDO"}

    index: IntProperty(name="State", description="Row of the list; -1: as drawn", default=DRAWN)

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene = context.scene
        settings = scene.perception_entropy
        rows = settings.states
        frame = rows[self.index].frame if 0 <= self.index < len(rows) else settings.drawn_frame
        if frame < 0:
            error = pe.InputError("scene", "state", "a state with a frame of the scene", "none")
            return report_error(self, error)
        scene.frame_set(frame)
        signals.study_changed.emit()
        return {"FINISHED"}


class PE_OT_add_weather(bpy.types.Operator):
    """Add a weather in which the rig is scored"""

    bl_idname = "pe.add_weather"
    bl_label = "Add Weather"
    bl_options = {"REGISTER", "UNDO"}

    weather: EnumProperty(items=WEATHERS, name="Weather", description="What it starts with")

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        label = next(label for key, label, _ in WEATHERS if key == self.weather)
        name = free_name(label, {row.name for row in settings.weathers})
        row = settings.weathers.add()
        row.name, row.night = name, self.weather == "NIGHT"
        if self.weather in STARTS:
            setattr(row, *STARTS[self.weather])
        settings.weather_index = len(settings.weathers) - 1
        signals.study_changed.emit()
        return {"FINISHED"}


class PE_OT_remove_state(RemoveRow, bpy.types.Operator):
    """Remove the selected state"""

    bl_idname = "pe.remove_state"
    bl_label = "Remove State"
    bl_options = {"REGISTER", "UNDO"}
    ROWS, INDEX, NOUN = "states", "state_index", "state"


class PE_OT_remove_weather(RemoveRow, bpy.types.Operator):
    """Remove the selected weather"""

    bl_idname = "pe.remove_weather"
    bl_label = "Remove Weather"
    bl_options = {"REGISTER", "UNDO"}
    ROWS, INDEX, NOUN = "weathers", "weather_index", "weather"


CLASSES = (
    PE_OT_add_state,
    PE_OT_read_states,
    PE_OT_show_state,
    PE_OT_add_weather,
    PE_OT_remove_state,
    PE_OT_remove_weather,
)
