"""Runs inside a Blender: exports a vehicle's file with every exporter there is, default settings.

``blender -b --factory-startup --python inside.py -- BLEND FOLDER``, or with a Python that has bpy:
``python inside.py BLEND FOLDER``.
"""

import sys
from pathlib import Path

import bpy


def exporters():
    """What writes a format, by its ending; of those that this Blender has."""
    wm = bpy.ops.wm
    found = {
        "glb": ("gltf", lambda path: bpy.ops.export_scene.gltf(filepath=path)),
        "obj": ("obj_export", lambda path: wm.obj_export(filepath=path)),
        "ply": ("ply_export", lambda path: wm.ply_export(filepath=path)),
        "stl": ("stl_export", lambda path: wm.stl_export(filepath=path)),
        "dae": ("collada_export", lambda path: wm.collada_export(filepath=path)),
    }
    for ending in ("usda", "usdc", "usdz"):
        found[ending] = ("usd_export", lambda path: wm.usd_export(filepath=path))
    rooms = {"glb": bpy.ops.export_scene}
    names = {ending: name for ending, (name, _) in found.items()}
    return {
        ending: write
        for ending, (_, write) in found.items()
        if names[ending] in dir(rooms.get(ending, wm))
    }


def main(blend: str, folder: str) -> None:
    """Export, and say which version wrote what."""
    bpy.ops.wm.open_mainfile(filepath=blend)
    version = bpy.app.version_string
    for ending, write in exporters().items():
        path = Path(folder) / f"{Path(blend).stem}.{ending}"
        try:
            write(str(path))
        except (RuntimeError, AttributeError) as error:
            said = str(error).strip().splitlines()
            print(f"EXPORT\t{version}\t{ending}\t{said[-1] if said else 'failed'}", flush=True)
            continue
        print(
            f"EXPORT\t{version}\t{ending}\t{'' if path.exists() else 'nothing written'}", flush=True
        )


if __name__ == "__main__":
    own = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    main(*own)
