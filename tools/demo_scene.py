"""Make the scene of the demo: a LiDAR and a camera, side by side at the front edge of a roof.

They may slide on the roof and be tilted. It is a first guess that a search can improve.

usage: python tools/demo_scene.py START.blend              in bpy
       blender -b --python tools/demo_scene.py -- START.blend    with the extension enabled
"""

import os
import sys
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT))
VEHICLE = ROOT / "blend_assets" / "sedan.blend"
LIDAR = "roof_lidar"
CAMERA = "front_camera"
CAMERA_MODEL = "Camera 60 deg"
ABOVE_ROOF_M = 0.1
"""Height of a sensor's optical centre above the surface that it is mounted on."""
ASIDE_M = 0.35
"""How far to the left of the camera, which is in the middle, the LiDAR starts."""
FREE = (True, True, False, False, True, False)
"""Which of x, y, z, roll, pitch and yaw the search may change: places on the roof, and the tilt."""


def make(start: Path) -> None:
    """Add the camera and the mount to the sedan, and save the scene."""
    bpy.ops.wm.open_mainfile(filepath=str(VEHICLE), load_ui=False)
    settings = bpy.context.scene.perception_entropy
    bpy.ops.pe.add_sensor(model=CAMERA_MODEL)
    camera = bpy.context.object
    lidar = bpy.data.objects[LIDAR]
    camera.name = CAMERA
    lidar.location = (camera.location.x, ASIDE_M, camera.location.z)
    roof = settings.mounts.add()
    roof.name = "roof"
    roof.standoff = ABOVE_ROOF_M
    roof.parts.add().part = bpy.data.objects["roof"]
    for sensor in (lidar, camera):
        bpy.ops.pe.mount_sensor(name=sensor.name, mount=roof.name)
        sensor.perception_entropy.free = FREE
    bpy.ops.wm.save_as_mainfile(filepath=str(start), compress=True)


def main() -> None:
    """Make the scene in the Blender that runs this, or in bpy."""
    start = Path(sys.argv[-1]).resolve()
    if hasattr(bpy.types.Scene, "perception_entropy"):
        make(start)
        return
    import blender_addon

    blender_addon.register()
    try:
        make(start)
    finally:
        blender_addon.unregister()
    os._exit(0)  # bpy may wait for its own threads for good


if __name__ == "__main__":
    main()
