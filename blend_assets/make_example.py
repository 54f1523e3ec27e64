"""Make the vehicle or the .blend of one of examples/: with bpy 4.2, later versions read its files.

`python make_example.py vehicle NAME` writes examples/NAME/vehicle.npz, the mesh of its studies.
`python make_example.py blend NAME` writes examples/NAME/NAME.blend, the scene of its decided.toml.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE)]

import make_city_bus  # noqa: E402
import make_truck  # noqa: E402
from blend_file import save  # noqa: E402
from export_mesh import mesh_of_scene  # noqa: E402

import blender_addon  # noqa: E402
from blender_addon import document  # noqa: E402
from blender_addon.engine import formats, pe  # noqa: E402

FOLDER = HERE.parent / "examples"
VEHICLES = {
    "robotaxi_sedan": "sedan.blend",
    "delivery_shuttle": "bus.blend",
    "city_bus": make_city_bus.build,
    "truck_trailer": make_truck.build,
}
"""What each example's vehicle is: a file with sensors of its own, or what builds it."""
DECIDED = "decided.toml"


def open_vehicle(name: str) -> None:
    """Have the open file hold an example's vehicle, without sensors."""
    source = VEHICLES[name]
    if callable(source):
        source()
        scene = bpy.context.scene
        scene.perception_entropy.vehicle = scene.collection.children[0]
        for obj in scene.perception_entropy.vehicle.objects:
            materials = {slot.material.name for slot in obj.material_slots}
            obj.perception_entropy.see_through = materials == {"glass"}
        bpy.context.view_layer.update()  # else the wheels are still at the origin
        return
    bpy.ops.wm.open_mainfile(filepath=str(HERE / source))
    for obj in document.sensor_objects(bpy.context.scene):
        bpy.data.objects.remove(obj)


def write_vehicle(name: str) -> None:
    """Write the mesh of an example's studies."""
    (FOLDER / name).mkdir(parents=True, exist_ok=True)
    formats.write_mesh(FOLDER / name / "vehicle.npz", mesh_of_scene())


def write_blend(name: str) -> None:
    """Write the scene of what was decided: the same problem as its study."""
    study = pe.load_study(FOLDER / name / DECIDED)
    lost = document.load_into(bpy.context.scene, study)
    if lost:
        raise SystemExit(f"{name}: the scene cannot hold {', '.join(lost)}")
    save(FOLDER / name / f"{name}.blend")


def main(what: str, name: str) -> None:
    """Make a file of an example."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    blender_addon.register()
    try:
        open_vehicle(name)
        {"vehicle": write_vehicle, "blend": write_blend}[what](name)
    finally:
        blender_addon.unregister()


if __name__ == "__main__":
    main(*sys.argv[1:3])
    sys.stdout.flush()
    os._exit(0)  # bpy 4.2 itself may crash while Python ends; all is written by now
