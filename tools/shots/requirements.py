"""A rig that is held to requirements: zones in the 3D view, verdicts in the list."""

from __future__ import annotations

from .guide import LOOK, OURS, SETTINGS, settled
from .reel import Camera, Reel

BEHIND = LOOK.format(center=(0.35, -2.6, 0.3), distance=13.5, rotation=(0.98, 0.0, -0.9))
PRESETS = (
    "r158_camera",
    "r151_moving",
    "ncap26_reverse_static",
    "r159_longitudinal",
    "park_aid_front",
    "perceptor_ground",
)
SHOWN = OURS.format("overlay.layer_cache") + ".shown_of(window.scene.name, 'requirements')"

EXACT = f"not any(v.preview for item in {SHOWN}.values() for v in item.shape.verdicts)"


def held(camera: Camera) -> None:
    """A LiDAR on the roof and two cameras, held to six presets."""
    stage = camera.stage
    stage.do("""
        for x, y, z, yaw in ((2.33, 0.0, 0.65, 0.0), (-2.6, 0.0, 0.9, 3.14159)):
            bpy.ops.pe.add_sensor(model="Camera 120 deg")
            bpy.context.object.location = (x, y, z)
            bpy.context.object.rotation_euler = (0.0, 0.15, yaw)
    """)
    stage.do(f"""
        {SETTINGS.strip()}
        for name in ("beams", "frustums", "ground", "blind", "reach"):
            setattr(settings.view, "show_" + name, False)
        for preset in {PRESETS!r}:
            bpy.ops.pe.add_row(rows="requirements", kind=preset)
        settings.requirement_index = 0
        bpy.ops.object.select_all(action="DESELECT")
        window.view_layer.objects.active = None
    """)
    stage.do(BEHIND)
    stage.wait_until(SHOWN, 120)
    settled(camera)
    stage.wait_until(EXACT, 120)
    stage.point_at(1110, 330)
    stage.do("bpy.ops.wm.call_panel('INVOKE_DEFAULT', name='PE_PT_requirements', keep_open=True)")
    stage.rest()
    camera.still("requirements")


REQUIREMENTS = Reel("sedan.blend", (held,))
