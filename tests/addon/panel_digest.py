"""A digest of what the panels show: pictures of another one are older than the panel.

``python -m tests.addon.panel_digest`` writes it beside the pictures; with ``--print`` it says it.
"""

import hashlib
import sys
from os import _exit as end_at_once
from pathlib import Path

import bpy

from tests.addon import layouts, scenes

KEPT = Path(__file__).resolve().parents[2] / "docs" / "images" / "panel.txt"


def digest(scene) -> str:
    """Return the digest of all panels, in *Simple* and in *All*, on a scene with a vehicle.

    It is of the kinds and names of what is drawn, and of labels without figures.
    """
    from blender_addon.panels import CLASSES  # once there is bpy

    window = layouts.Window(scene, scene.objects["roof"])
    drawn = []
    for panels in ("SIMPLE", "ALL"):
        scene.perception_entropy.panels = panels
        for cls in CLASSES:
            if issubclass(cls, bpy.types.Panel) and cls.poll(window):
                notes = layouts.drawn(cls, **vars(window)).notes
                named = (str(note) for note in notes if not any(map(str.isdigit, str(note[1]))))
                drawn += [panels, cls.__name__, cls.bl_label, *named]
    return hashlib.sha256("\n".join(drawn).encode()).hexdigest()[:16]


def scene_of_digest():
    """Return the open scene with what the digest is of: a car, and a LiDAR on its roof."""
    scenes.add_car(bpy.context.scene)
    scenes.add_sensor("roof", "Velodyne VLP-16 Puck", location=(-0.43, 0.0, 1.8))
    return bpy.context.scene


def main() -> None:
    """Write or print the digest of this checkout's panels: in a Blender that has done nothing."""
    import blender_addon

    bpy.ops.wm.read_factory_settings(use_empty=True)
    blender_addon.register()
    found = digest(scene_of_digest())
    if "--print" in sys.argv:
        print(found, flush=True)
    else:
        KEPT.write_text(f"{found}\n")
    end_at_once(0)  # at its own exit, bpy may wait for a thread for ever


if __name__ == "__main__":
    main()
