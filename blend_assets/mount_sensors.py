"""Mount the example sensors on a vehicle: `python mount_sensors.py sedan.blend` or `... bus.blend`
with the bpy module.

Marks the vehicle's collection and its glass, puts LiDARs on it, and saves the file again. Run it
after make_sedan.py or make_bus.py, with bpy 4.2: later versions read its files.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import NamedTuple

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

from blend_file import save  # noqa: E402

import blender_addon  # noqa: E402

SCREENS = ("windshield", "rear_window", "windows_left", "windows_right")


class Sensor(NamedTuple):
    """A model of the catalogue, where it stands [m], its pitch [deg], and the axes to search."""

    model: str
    location: tuple[float, float, float]
    pitch: float = 0.0
    free: tuple[bool, ...] | None = None  # as the add-on has it


class Mounting(NamedTuple):
    """Which objects of a vehicle cameras see through, and its sensors by name."""

    glass: tuple[str, ...]
    sensors: dict[str, Sensor]


MOUNTINGS = {
    "Sedan": Mounting(
        glass=SCREENS,
        # x, z and pitch: a single LiDAR stays on the centre line.
        sensors={
            "roof_lidar": Sensor(
                "Pandar64", (-0.43, 0.0, 1.80), free=(True, False, True, False, True, False)
            )
        },
    ),
    # Ma, Liu and Li, Perception Entropy, ICRA 2021, Table II, experiment 3, first row.
    "Bus": Mounting(
        glass=(*SCREENS, "door_windows"),
        sensors={
            "lidar_front_right": Sensor("Pandar40", (3.03, -1.01, 1.16), pitch=-0.3),
            "lidar_rear_left": Sensor("Pandar40", (-3.03, 1.01, 0.85), pitch=3.2),
        },
    ),
}
"""By the collection of the vehicle."""


def mount() -> None:
    """Set the vehicle of the open file, its glass, and its sensors."""
    scene = bpy.context.scene
    (vehicle,) = [name for name in MOUNTINGS if name in bpy.data.collections]
    scene.perception_entropy.vehicle = bpy.data.collections[vehicle]
    for name in MOUNTINGS[vehicle].glass:
        bpy.data.objects[name].perception_entropy.see_through = True
    for name, sensor in MOUNTINGS[vehicle].sensors.items():
        place(scene, name, sensor)


def place(scene: bpy.types.Scene, name: str, sensor: Sensor) -> None:
    """Add a sensor unless it is there, and put it in its place."""
    if name not in scene.objects:
        bpy.ops.pe.add_sensor(model=sensor.model)
        bpy.context.object.name = name
    mounted = scene.objects[name]
    mounted.location = sensor.location
    mounted.rotation_euler = (0.0, np.radians(sensor.pitch), 0.0)
    if sensor.free is not None:
        mounted.perception_entropy.free = sensor.free


def main() -> None:
    """Read the arguments, mount and save."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("blend", nargs="?", type=Path, default=HERE / "sedan.blend")
    path = parser.parse_args().blend.resolve()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    blender_addon.register()
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path))
        mount()
        save(path)
    finally:
        blender_addon.unregister()


if __name__ == "__main__":
    main()
