"""Where the vehicle's axles are: other programs have their origin at the rear one."""

from __future__ import annotations

from bpy.props import BoolProperty, FloatProperty, StringProperty

from .callbacks import redraw


def _metres(name: str, description: str, least: float = 0.0, default: float = 0.0) -> FloatProperty:
    return FloatProperty(
        name=name,
        description=description,
        default=default,
        min=least,
        max=100.0,
        soft_max=10.0,
        precision=3,
        unit="LENGTH",
        update=redraw,
    )


class AxleSettings:
    """A part of the scene's settings: what exports need besides the rig."""

    passthrough: StringProperty(
        name="Kept of the Imported File",
        description="What the file of an imported rig had besides the rig: an export to its own "
        "format has it again",
        options={"HIDDEN"},
    )

    axles_known: BoolProperty(
        name="Axles",
        description="Say where the axles are: the origin of Autoware, nuScenes, ASAM OSI and "
        "DriveWorks is the rear one",
        update=redraw,
    )
    rear_axle_x: _metres(
        "Rear Axle X", "Middle of the rear axle: forward of the origin", -100.0, -1.3
    )
    rear_axle_z: _metres("Rear Axle Z", "Middle of the rear axle: above the ground", 0.001, 0.3)
    wheelbase: _metres("Wheelbase", "From the rear axle to the front one; 0: not known")
    front_overhang: _metres("Front Overhang", "In front of the front axle; 0: not known")
    rear_overhang: _metres("Rear Overhang", "Behind the rear axle; 0: not known")
