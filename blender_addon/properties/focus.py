"""A focus weight: a row of the panel's list."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, FloatProperty, FloatVectorProperty

from ..choices import REGION_ITEMS
from ..engine import pe
from .callbacks import changed

DEFAULT_FOCUS = 2.0
DEFAULT_REGION = "front"
RANGE_DECIMALS = 3

OBJECT_CLASSES = tuple(
    (name, name.capitalize(), f"Weigh {name}s") for name in pe.Prior.road().class_names
)


class PE_FocusSettings(bpy.types.PropertyGroup):
    """A focus weight: what counts more than the prior says, or less. Its name is the user's."""

    factor: FloatProperty(
        name="Factor",
        description="How many times as much it counts: 2 doubles it, 0 leaves it out. Where "
        "several regions overlap, their factors multiply",
        default=DEFAULT_FOCUS,
        min=0.0,
        soft_max=10.0,
        update=changed,
    )
    region: EnumProperty(
        items=REGION_ITEMS,
        name="Region",
        description="Which part of the ground",
        default=DEFAULT_REGION,
        update=changed,
    )
    x_range: FloatVectorProperty(
        name="X",
        description="From and to, ahead of the origin; negative is behind it",
        size=2,
        default=pe.PerceptionSpace().x,
        unit="LENGTH",
        precision=RANGE_DECIMALS,
        update=changed,
    )
    y_range: FloatVectorProperty(
        name="Y",
        description="From and to, on the left of the origin; negative is on its right",
        size=2,
        default=pe.PerceptionSpace().y,
        unit="LENGTH",
        precision=RANGE_DECIMALS,
        update=changed,
    )
    classes: EnumProperty(
        items=OBJECT_CLASSES,
        name="Classes",
        description="Which kinds of objects. Shift-click for several",
        options={"ENUM_FLAG"},
        default={name for name, *_ in OBJECT_CLASSES},
        update=changed,
    )
