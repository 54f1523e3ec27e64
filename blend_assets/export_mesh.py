"""Write the vehicles' triangles for the engine: `python export_mesh.py` with the bpy module makes
sedan.npz and bus.npz beside the .blend files, with the same numbers that the add-on scores."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import bpy

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import blender_addon  # noqa: E402
from blender_addon import document  # noqa: E402
from pe_tools.formats import Mesh, write_mesh  # noqa: E402


def mesh_of_scene() -> Mesh:
    """The vehicle of the open file; the add-on must be registered."""
    collection = bpy.context.scene.perception_entropy.vehicle
    vehicle = document.vehicle_from_collection(collection, bpy.context.evaluated_depsgraph_get())
    return Mesh(vehicle.triangles, vehicle.parts, tuple(vehicle.part_names))


def main() -> None:
    """Read the arguments and export."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "blend", nargs="*", type=Path, default=[HERE / "sedan.blend", HERE / "bus.blend"]
    )
    paths = [path.resolve() for path in parser.parse_args().blend]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    blender_addon.register()
    try:
        for path in paths:
            bpy.ops.wm.open_mainfile(filepath=str(path))
            write_mesh(path.with_suffix(".npz"), mesh_of_scene())
    finally:
        blender_addon.unregister()


if __name__ == "__main__":
    main()
