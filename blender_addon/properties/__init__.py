"""What the add-on stores in a .blend file: on the scene, and on every object.

Here is what the user typed, and small summaries of the last result. Arrays live elsewhere.
"""

import bpy
from bpy.props import PointerProperty

from ..sensor_kinds import DEFAULT_MODEL
from ..view.view_settings import ViewSettings
from .callbacks import model_suggestions
from .declared import ROWS, DeclaredRow, declared_rows, rows_of
from .list_rows import (
    DEFAULT_REGION,
    PE_CurveSettings,
    PE_FocusSettings,
    PE_MountPart,
    PE_MountSettings,
    PE_OwnSensorSettings,
    PE_Scenario,
    PE_SensorOption,
    PE_State,
    PE_Variant,
    PE_Weather,
)
from .requirement import PE_Requirement
from .scene import INDEX_OF, PE_SceneSettings
from .sensor import AXIS_LABELS, FREE_BY_DEFAULT, PE_ObjectSettings, measured_distances
from .view import PE_LiveSettings, PE_ViewSettings

VIEW_ROWS = rows_of(ViewSettings)  # Fields of the settings of the 3D view, by property

CLASSES = (
    PE_CurveSettings,
    PE_OwnSensorSettings,
    PE_FocusSettings,
    PE_LiveSettings,
    PE_MountPart,
    PE_MountSettings,
    PE_SensorOption,
    PE_Requirement,
    PE_State,
    PE_Weather,
    PE_Scenario,
    PE_Variant,
    PE_ViewSettings,
    PE_SceneSettings,
    PE_ObjectSettings,
)


def add_pointers() -> None:
    """Add the settings to scenes and objects."""
    bpy.types.Scene.perception_entropy = PointerProperty(type=PE_SceneSettings)
    bpy.types.Object.perception_entropy = PointerProperty(type=PE_ObjectSettings)


def remove_pointers() -> None:
    """Remove the settings from Blender's types; files keep their values."""
    del bpy.types.Object.perception_entropy
    del bpy.types.Scene.perception_entropy
