"""Operators on rows of the panel: focus, own sensors, AP curves, bounds, axles, view settings."""

from __future__ import annotations

import math

import bpy
from bpy.props import EnumProperty, IntProperty

from .. import bridge, language, signals, vehicle_cache
from ..choices import BEFORE_MOVE, PINNED, REGION_ITEMS, free_name
from ..engine import catalog, kinds, pe, search
from ..live import live_state
from ..overlay.layer_cache import shown
from ..properties import DEFAULT_REGION
from ..sensor_kinds import own_kinds, row_of
from .list_rows import RemoveRow
from .reports import USER_ERRORS, OperatorResult, report, report_error


class PE_OT_add_focus(bpy.types.Operator):
    """Add a weight for a region, or for some classes of objects"""

    bl_idname = "pe.add_focus"
    bl_label = "Add Focus"
    bl_options = {"REGISTER", "UNDO"}

    region: EnumProperty(
        items=REGION_ITEMS,
        name="Region",
        description="Region of the ground",
        default=DEFAULT_REGION,
    )

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        name = free_focus_name({row.name for row in settings.focus})
        row = settings.focus.add()
        row.name, row.region = name, self.region
        settings.focus_index = len(settings.focus) - 1
        signals.study_changed.emit()
        report(self, "INFO", f"Added {name}")
        return {"FINISHED"}


class PE_OT_remove_focus(RemoveRow, bpy.types.Operator):
    """Remove the focus that is selected in the list"""

    bl_idname = "pe.remove_focus"
    bl_label = "Remove Focus"
    bl_options = {"REGISTER", "UNDO"}
    ROWS, INDEX, NOUN = "focus", "focus_index", "focus"


def free_focus_name(taken: set[str]) -> str:
    """Return the first of "Focus 1", "Focus 2" and so on that is not taken."""
    number = 1
    while f"Focus {number}" in taken:
        number += 1
    return f"Focus {number}"


BOUND_REACH = (0.5, 10.0)
"""New bounds are this far to either side of a sensor's value: metres, degrees."""


class PE_OT_add_own_sensor(bpy.types.Operator):
    """Define your own sensor: a LiDAR by channels, view and range, or a camera by its pixels"""

    bl_idname = "pe.add_own_sensor"
    bl_label = "Add Own Sensor"
    bl_options = {"REGISTER", "UNDO"}

    kind: EnumProperty(items=own_kinds, name="Kind", description="Kind of the sensor")

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        settings = context.scene.perception_entropy
        row = settings.own_sensors.add()
        row.kind = self.kind
        row.name = free_name(f"My {kinds.KINDS[row.kind].label}", set(catalog.entries()))
        settings.own_index = len(settings.own_sensors) - 1
        signals.study_changed.emit()
        return {"FINISHED"}


def own_fields(kind: str) -> tuple[str, ...]:
    """Return the properties that the panel shows of an own sensor of a kind."""
    return row_of(kind).own_fields


class PE_OT_remove_own_sensor(RemoveRow, bpy.types.Operator):
    """Remove this own sensor; sensors of this model can then no longer be scored"""

    bl_idname = "pe.remove_own_sensor"
    bl_label = "Remove Own Sensor"
    bl_options = {"REGISTER", "UNDO"}
    ROWS, INDEX, NOUN = "own_sensors", "own_index", "own sensor"


class PE_OT_own_curves(bpy.types.Operator):
    """Set your own AP curves; they start as the curves of each kind"""

    bl_idname = "pe.own_curves"
    bl_label = "Own AP Curves"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        rows = context.scene.perception_entropy.curves
        for name, kind in kinds.KINDS.items():
            if name not in rows:
                row = rows.add()
                row.name, row.a, row.b = name, kind.curve.a, kind.curve.b
        return {"FINISHED"}


class PE_OT_bound_axis(bpy.types.Operator):
    """Set bounds of the search around this sensor's value; press again to remove them"""

    bl_idname = "pe.bound_axis"
    bl_label = "Bound Axis"
    bl_options = {"REGISTER", "UNDO"}

    axis: IntProperty(name="Axis", description="x, y, z, roll, pitch, yaw", min=0, max=5)

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        obj = context.active_object
        settings = obj.perception_entropy
        try:
            pose = bridge.pose_of(obj, context.evaluated_depsgraph_get())
        except USER_ERRORS as error:
            return report_error(self, error)
        settings.bounded[self.axis] = not settings.bounded[self.axis]
        if settings.bounded[self.axis]:
            middle = (*pose.position, *map(math.degrees, pose.rpy))[self.axis]
            reach = BOUND_REACH[search.AXES[self.axis] not in ("x", "y", "z")]
            settings.bounds_low[self.axis] = round(middle - reach, 3)
            settings.bounds_high[self.axis] = round(middle + reach, 3)
        return {"FINISHED"}


class PE_OT_guess_axles(bpy.types.Operator):
    """Find the axles from the vehicle's parts with wheel, tire or tyre in their names"""

    bl_idname = "pe.guess_axles"
    bl_label = "From Wheels"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene = context.scene
        try:
            vehicle = vehicle_cache.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
            reference = pe.guessed_reference(vehicle)
            if reference is None:
                expected = "parts named as wheels, front and rear"
                raise pe.InputError("vehicle", "axles", expected, "none")
        except USER_ERRORS as error:
            return report_error(self, error)
        bridge.write_reference(scene.perception_entropy, reference)
        report(
            self,
            "INFO",
            f"Rear axle at x {reference.rear_axle_x:g} m, z {reference.rear_axle_z:g} m",
        )
        return {"FINISHED"}


RANGES = {"ENTROPY": "entropy_range", "COVERAGE": "coverage_range"}
"""The property of a fixed range, by quantity."""


class PE_OT_fix_colors(bpy.types.Operator):
    """Keep the present range of the ground map's colours"""

    bl_idname = "pe.fix_colors"
    bl_label = "Fix Colors"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        view = context.scene.perception_entropy.view
        items = shown.items(context.scene.name, "ground").values()
        bounds = next((i.shape.legend.bounds for i in items if i.shape.legend is not None), None)
        if bounds is None or view.ground_difference or view.ground_quantity not in RANGES:
            report(self, "WARNING", "No ground map of entropy or coverage is shown")
            return {"CANCELLED"}
        setattr(view, RANGES[view.ground_quantity], bounds)
        view.ground_range = "FIXED"
        return {"FINISHED"}


class PE_OT_fit_colors(bpy.types.Operator):
    """Fit the range of the ground map's colours to what is shown now"""

    bl_idname = "pe.fit_colors"
    bl_label = "Fit Colors"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        view = context.scene.perception_entropy.view
        view.ground_range = "FITTED"
        view.ground_fits += 1
        return {"FINISHED"}


REFERENCE_LABELS = {BEFORE_MOVE: "Before the Last Move", PINNED: "Pinned Sensors"}


class PE_OT_live_against(bpy.types.Operator):
    """Compare the live score with this reference"""

    bl_idname = "pe.live_against"
    bl_label = "Compare Live With"
    bl_options = {"INTERNAL"}

    key: IntProperty(
        name="Key",
        description="0: the sensors before the last move; -1: pin the scene's present sensors; "
        "otherwise the key of a variant",
        options={"HIDDEN", "SKIP_SAVE"},
    )

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: bpy.types.Operator) -> str:
        if properties.key == PINNED:
            return language.shown(
                "Pin the sensors as they are now: compare the live score with them from now on"
            )
        return language.shown(str(cls.__doc__))

    def execute(self, context: bpy.types.Context) -> OperatorResult:
        scene = context.scene
        if self.key == PINNED:
            state = live_state(scene.name)
            if state.score is None or not state.is_current(state.score):
                report(self, "WARNING", "Live has not scored the sensors as they are now yet")
                return {"CANCELLED"}
            state.pinned = state.score.rig
        scene.perception_entropy.live.against = self.key
        return {"FINISHED"}


def reference_label(scene: bpy.types.Scene) -> str:
    """Return what the live score of a scene is compared with, for the panel."""
    choice = scene.perception_entropy.live.against
    if choice == PINNED and live_state(scene.name).pinned is not None:
        return REFERENCE_LABELS[PINNED]
    names = {row.key: row.name for row in scene.perception_entropy.variants}
    return names.get(choice, REFERENCE_LABELS[BEFORE_MOVE])


CLASSES = (
    PE_OT_add_focus,
    PE_OT_remove_focus,
    PE_OT_add_own_sensor,
    PE_OT_remove_own_sensor,
    PE_OT_own_curves,
    PE_OT_bound_axis,
    PE_OT_guess_axles,
    PE_OT_fit_colors,
    PE_OT_fix_colors,
    PE_OT_live_against,
)
