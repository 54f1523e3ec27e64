"""Mount the example sensor on sedan.blend: `python mount_sensors.py` with the bpy module.

Marks the sedan as the vehicle and its windows as glass, puts a LiDAR on the roof, and saves the
file again. Run it after make_sedan.py, with bpy 4.2: later versions read its files.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import blender_addon  # noqa: E402

VEHICLE = "Sedan"
GLASS = ("windshield", "rear_window", "windows_left", "windows_right")
ROOF_LIDAR = "roof_lidar"
ROOF_LIDAR_M = (-0.43, 0.0, 1.80)
FREE = (True, False, True, False, True, False)
"""x, z and pitch: a single LiDAR stays on the centre line."""


def mount() -> None:
    """Set the vehicle, its glass, and the sensor on its roof."""
    scene = bpy.context.scene
    scene.perception_entropy.vehicle = bpy.data.collections[VEHICLE]
    for name in GLASS:
        bpy.data.objects[name].perception_entropy.see_through = True
    if ROOF_LIDAR not in scene.objects:
        bpy.ops.pe.add_sensor(model="Pandar64")
        bpy.context.object.name = ROOF_LIDAR
    roof_lidar = scene.objects[ROOF_LIDAR]
    roof_lidar.location = ROOF_LIDAR_M
    roof_lidar.perception_entropy.free = FREE


def main() -> None:
    """Read the arguments, mount and save."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("blend", nargs="?", type=Path, default=HERE / "sedan.blend")
    path = str(parser.parse_args().blend.resolve())
    bpy.ops.wm.read_factory_settings(use_empty=True)
    blender_addon.register()
    try:
        bpy.ops.wm.open_mainfile(filepath=path)
        mount()
        bpy.context.preferences.filepaths.save_version = 0  # no .blend1 beside it
        bpy.ops.wm.save_as_mainfile(filepath=path, compress=True)
    finally:
        blender_addon.unregister()


if __name__ == "__main__":
    main()
