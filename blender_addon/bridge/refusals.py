"""What is wrong with a sensor, kept at it for the panel to show, and what mends it."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..engine import pe
from .rig import sensor_from_object

SCALE, MODEL = "scale", "model"
MENDS = {SCALE: "Ctrl-A > Scale, or the button below, mends it"}


def note_refusals(sensors: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> list[str]:
    """Write at each sensor why it is refused, or nothing; return whose that changed."""
    changed = []
    for obj in sensors:
        settings = obj.perception_entropy
        field, said = refusal_of(obj, depsgraph)
        if (settings.refused_field, settings.refusal) != (field, said):
            settings.refused_field, settings.refusal = field, said
            changed.append(obj.name)
    return changed


def refusal_of(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> tuple[str, str]:
    """Return the field that a sensor is refused for, and a line why; empty where it is not."""
    if not obj.visible_get(view_layer=depsgraph.view_layer):
        return "", ""
    try:
        sensor_from_object(obj, depsgraph)
    except pe.InputError as error:
        field = error.field.rpartition(": ")[2]
        mend = f". {MENDS[field]}" if field in MENDS else ""
        return field, f"{field}: expected {error.expected}, found {error.found}{mend}"
    return "", ""
