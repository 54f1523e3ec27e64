"""What the add-on stores in a .blend file: on the scene, and on every object.

Here is what the user typed, and small summaries of the last result. Arrays live elsewhere.
"""

from __future__ import annotations

import bpy
from bpy.props import PointerProperty

from .advanced import OWN_KINDS, PE_CurveSettings, PE_OwnSensorSettings
from .breakdown import PE_ResultPart
from .callbacks import model_suggestions
from .focus import DEFAULT_REGION, PE_FocusSettings
from .live import PE_LiveSettings
from .mounting import PE_MountPart, PE_MountSettings
from .scene import PE_SceneSettings
from .selection import PE_FrontRow, PE_SensorOption
from .sensor import AXIS_LABELS, DEFAULT_MODEL, FREE_BY_DEFAULT, PE_ObjectSettings
from .variants import PE_Variant, PE_VariantSensor
from .view import PE_ViewSettings
from .warnings import PE_StoppingPart, PE_Warning

__all__ = [
    "AXIS_LABELS",
    "CLASSES",
    "DEFAULT_MODEL",
    "DEFAULT_REGION",
    "FREE_BY_DEFAULT",
    "OWN_KINDS",
    "model_suggestions",
]

CLASSES = (
    PE_CurveSettings,
    PE_OwnSensorSettings,
    PE_FocusSettings,
    PE_LiveSettings,
    PE_MountPart,
    PE_MountSettings,
    PE_SensorOption,
    PE_FrontRow,
    PE_VariantSensor,
    PE_Variant,
    PE_Warning,
    PE_ResultPart,
    PE_StoppingPart,
    PE_ViewSettings,
    PE_SceneSettings,
    PE_ObjectSettings,
)


def add_pointers() -> None:
    """Hang the settings on scenes and objects."""
    bpy.types.Scene.perception_entropy = PointerProperty(type=PE_SceneSettings)
    bpy.types.Object.perception_entropy = PointerProperty(type=PE_ObjectSettings)


def remove_pointers() -> None:
    """Take them off again; what files hold stays in them."""
    del bpy.types.Object.perception_entropy
    del bpy.types.Scene.perception_entropy
