"""Make examples/four_corners: `python make_four_corners.py` with the bpy module, after the bus.

The shuttle with a LiDAR at each corner of its roof, level as they come out of the box, and a camera
in each rear corner of its bumper, as mirrored pairs, on areas that are painted on its body. The
scene and the study are one problem; the study takes its mesh from bus.npz. Run it with bpy 4.2:
later versions read its files.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

from blend_file import save  # noqa: E402

import blender_addon  # noqa: E402
from blender_addon import document  # noqa: E402
from blender_addon.engine import formats, pe  # noqa: E402

FOLDER = HERE / "examples" / "four_corners"
LIDAR = "Velodyne VLP-16 Puck"
CAMERA = "Camera 120 deg"
ROOF = "roof corners"
BUMPER = "rear bumper"
BASE_M = 0.04
RECESS_M = 0.01
"""A base plate of 40 mm on the roof; a lens 10 mm proud of the bumper."""
SIDE_M = (0.3, 1.0)
"""Bounds of y of the sensors on the left: each pair has one on either side."""
END_M = (1.3, 3.1)
"""Bounds of x of a pair at the front; one at the rear has them with the other sign."""

BLIND_GROUND_M2 = 67.0
"""The limit of what stays blind within 10 m: half of what is blind at the start."""
PRESETS = (
    "r159_longitudinal",
    "r151_static_crossing",
    "r151_static_parallel",
    "r158_camera",
    "r158_detection",
    "ncap26_reverse_static",
    "ncap26_reverse_moving",
)
METHOD = "portfolio"
"""Of the example's search."""
STOPPING = "Adult within the stopping distance"
STOPPING_M = "15"
"""At 25 km/h: 6.9 m in the first second, then 3 m/s2: 8.0 m. An estimate for shuttles."""

Vertex = bpy.types.MeshVertex


def at_corner(place: Vertex) -> bool:
    """Whether a point of the roof is in a corner, and not on its steep rim."""
    return abs(place.x) > 1.3 and 0.35 < abs(place.y) < 0.86


def on_upright_part(place: Vertex) -> bool:
    """Whether a point of the rear bumper is on the part that a lens fits into."""
    return place.z > 0.27 and place.x < -2.5 and abs(place.y) > 0.15


def paint(part: str, name: str, chosen: Callable[[Vertex], bool]) -> None:
    """Paint a vertex group on a part of the shuttle, and make a mount of it."""
    obj = bpy.data.objects[part]
    group = obj.vertex_groups.new(name=name)
    group.add([v.index for v in obj.data.vertices if chosen(v.co)], 1.0, "REPLACE")


def add_mount(name: str, standoff: float, orientation: str) -> None:
    """Add a mount of the faces that are painted under its name."""
    row = bpy.context.scene.perception_entropy.mounts.add()
    row.name = name
    row.faces = "GROUP"
    row.group = name
    row.standoff = standoff
    row.orientation = orientation


def add_pair(
    name: str,
    model: str,
    near: tuple[float, float, float],
    mount: str,
    yaw: tuple[float, float, float],
    pitch: tuple[float, float],
) -> None:
    """Add a sensor on the left, on a mount, and its mirror image. `yaw`: start and bounds, `pitch`:
    bounds, from what the mount says [deg]."""
    bpy.ops.pe.add_sensor(model=model)
    obj = bpy.context.object
    obj.name = f"{name}_left"
    obj.location = near
    bpy.context.view_layer.update()
    bpy.ops.pe.mount_sensor(name=obj.name, mount=mount)
    own = obj.perception_entropy
    obj.rotation_euler.z += math.radians(yaw[0])
    own.free = [False, False, False, False, True, True]
    first, last = END_M
    ends = (first, last) if near[0] > 0.0 else (-last, -first)
    for index, (low, high) in ((0, ends), (1, SIDE_M), (4, pitch), (5, yaw[1:])):
        own.bounded[index] = True
        own.bounds_low[index] = low
        own.bounds_high[index] = high
    bpy.ops.pe.mirror_sensor(name=obj.name, linked=True)


def add_requirements() -> None:
    """Hold the shuttle to presets, and to an adult ahead that two sensors see."""
    settings = bpy.context.scene.perception_entropy
    for preset in PRESETS:
        bpy.ops.pe.add_row(rows="requirements", kind=preset)
    bpy.ops.pe.add_row(rows="requirements", kind="OWN")
    row = settings.requirements[-1]
    row.name = STOPPING
    row.zone = f'x = ["front + 3.7", "front + {STOPPING_M}"], y = ["right", "left"]'
    row.one_lost = True
    settings.requirement_index = 0


def design() -> None:
    """Have the bus's scene hold this example."""
    for obj in document.sensor_objects(bpy.context.scene):
        bpy.data.objects.remove(obj)
    paint("roof", ROOF, at_corner)
    paint("bumper_rear", BUMPER, on_upright_part)
    add_mount(ROOF, BASE_M, "upright")
    add_mount(BUMPER, RECESS_M, "facing")
    tilt = (-5.0, 45.0)
    add_pair("front", LIDAR, (2.2, 0.7, 2.6), ROOF, yaw=(45.0, 0.0, 90.0), pitch=tilt)
    add_pair("rear", LIDAR, (-2.2, 0.7, 2.6), ROOF, yaw=(135.0, 90.0, 180.0), pitch=tilt)
    aside = (0.0, -40.0, 40.0)
    add_pair("camera", CAMERA, (-3.0, 0.7, 0.42), BUMPER, yaw=aside, pitch=(-20.0, 30.0))
    add_requirements()
    settings = bpy.context.scene.perception_entropy
    settings.limit_distance = 0.3
    settings.limit_height = 2.7
    settings.method = METHOD  # said, so that another default changes nothing
    settings.keep_requirements = True
    settings.limit_blind_ground = BLIND_GROUND_M2
    settings.keep_traffic_ap = True
    settings.keep_blind_sector = False  # the study does not name it


def write_study() -> None:
    """Write the scene as a study beside the others, its areas in a file of their own."""
    scene = bpy.context.scene
    study = document.study_from_scene(scene, bpy.context.evaluated_depsgraph_get())
    mounts = study.search.mounting.mounts
    areas = [mount.area.triangles for mount in mounts.values()]
    parts = np.repeat(np.arange(len(areas), dtype=np.int32), [len(area) for area in areas])
    formats.write_mesh(FOLDER / "areas.npz", pe.Mesh(np.concatenate(areas), parts, tuple(mounts)))
    study = replace(study.with_mesh("../../bus.npz"), samples=0)  # all voxels
    pe.save_study(study, FOLDER / "study.toml")


def main() -> None:
    """Make all of it."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    blender_addon.register()
    try:
        bpy.ops.wm.open_mainfile(filepath=str(HERE / "bus.blend"))
        design()
        write_study()
        save(FOLDER / "four_corners.blend")
    finally:
        blender_addon.unregister()


if __name__ == "__main__":
    main()
