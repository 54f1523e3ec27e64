"""Which sensors: models offered for a sensor's place, and the search for the front of all."""

from __future__ import annotations

import bpy
from bpy.props import IntProperty

from .. import bridge, changes, stale
from ..engine import pe
from .job import JobOperator, SceneJob
from .reports import tell


class OptionOperator:
    """What operators on the active sensor's models share."""

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        obj = context.active_object
        if obj is None or not obj.perception_entropy.is_sensor:
            cls.poll_message_set("Select a sensor")
            return False
        return True


class PE_OT_add_option(OptionOperator, bpy.types.Operator):
    """Offer a model for this sensor's place: first its own, then others that you choose"""

    bl_idname = "pe.add_option"
    bl_label = "Add Model"

    def execute(self, context: bpy.types.Context) -> set[str]:
        own = context.active_object.perception_entropy
        first = not own.options
        option = own.options.add()
        option.model = own.model if first else ""
        return {"FINISHED"}


class PE_OT_remove_option(OptionOperator, bpy.types.Operator):
    """Offer this model no longer"""

    bl_idname = "pe.remove_option"
    bl_label = "Remove Model"

    index: IntProperty(name="Index", description="Which of the models", min=0)

    def execute(self, context: bpy.types.Context) -> set[str]:
        options = context.active_object.perception_entropy.options
        if self.index >= len(options):
            tell(self, "WARNING", "There is no such model any more")
            return {"CANCELLED"}
        options.remove(self.index)
        return {"FINISHED"}


class PE_OT_choose_sensors(JobOperator, bpy.types.Operator):
    """Search for the designs that no other beats in price and entropy; each becomes a variant"""

    bl_idname = "pe.choose_sensors"
    bl_label = "Choose Sensors"
    bl_options = {"REGISTER", "UNDO"}

    def job_of(self, scene: bpy.types.Scene, study: pe.Study, _taken: bridge.Fingerprint) -> pe.Job:
        """Search, unless nothing is to be chosen."""
        bridge.check_choosable(scene, study)
        return pe.ChoiceJob(study)

    def _apply(self, scene: bpy.types.Scene | None, task: SceneJob) -> set[str]:
        """Keep the front as variants; undo takes them back in one step."""
        found = task.job.trade_off
        if found is None or scene is None:
            tell(self, "INFO", "Stopped before a design was complete: nothing was changed")
            return {"CANCELLED"}
        bridge.keep_front(scene, found, task.taken.surroundings)
        stale.check()
        changes.picture.tell()
        early = ", stopped early" if found.stopped else ""
        count = len(found.front)
        tell(self, "INFO", f"{count} designs on the front, kept as variants{early}")
        return {"FINISHED"}


CLASSES = (PE_OT_add_option, PE_OT_remove_option, PE_OT_choose_sensors)
