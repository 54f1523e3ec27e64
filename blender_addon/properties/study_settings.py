"""Properties of the scene that follow from the engine's declarations of settings.

A number or a switch that the engine declares with a panel field (`Setting.panel`) is a property of
the scene without another line here: its name in .blend files, its range, unit, label and tooltip
are those of the declaration. Menus are declared in `scene`: a .blend file holds numbers for them.
"""

from __future__ import annotations

import math
from typing import Any, cast

from bpy.props import BoolProperty, FloatProperty, FloatVectorProperty, IntProperty

from ..engine import studies
from .callbacks import changed, redraw

LARGEST_INT = 2**31 - 1
"""The largest whole number that a property can hold."""
DRAWN = "reference."
"""Settings whose keys begin so change the picture in the 3D view, and no score."""


def property_of(key: str, setting: studies.Setting) -> Any:
    """Return the property that a setting is stored in; its values are those of the panel."""
    panel, rule = setting.panel, cast(Any, setting.rule)
    assert panel is not None  # asked for those alone that have one
    options: dict[str, Any] = {
        "name": panel.label,
        "description": setting.tooltip,
        "default": studies.panel_default(setting),
        "soft_max": panel.soft_max,
        "precision": panel.precision,
        "step": panel.step,
        "update": changed if setting.scored else redraw if key.startswith(DRAWN) else None,
    }
    if isinstance(rule, studies.Toggle):
        return _made(BoolProperty, options)
    if isinstance(rule, studies.Pair):
        return _made(FloatVectorProperty, {**options, "size": 2, "unit": _unit(rule.rule)})
    low, high = (
        0 if setting.is_optional else rule.minimum if panel.min is None else panel.min,
        rule.maximum if panel.max is None else panel.max,
    )
    if isinstance(rule, studies.Whole):
        high = LARGEST_INT if high is None else min(high, LARGEST_INT)
        return _made(IntProperty, {**options, "min": low, "max": high})
    ends = {"min": low, "max": high if math.isfinite(high) else None}
    return _made(FloatProperty, {**options, **ends, "unit": _unit(rule)})


def _unit(rule: Any) -> str:
    return "LENGTH" if rule.unit == "m" else "NONE"


def _made(kind: Any, options: dict[str, Any]) -> Any:
    return kind(**{key: value for key, value in options.items() if value is not None})


StudySettings: Any = type(
    "StudySettings",
    (),
    {
        "__doc__": "A part of the scene's settings: all that the engine declares.",
        "__module__": __name__,
        "__annotations__": {
            setting.panel.property: property_of(key, setting)
            for key, setting in studies.setting_keys()
            if setting.panel is not None and not isinstance(setting.rule, studies.OneOf)
        },
    },
)
