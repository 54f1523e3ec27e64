"""What is in the file that is open, as a study."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import bpy

from .. import bridge
from ..engine import pe


def opened_study(variant: str | None = None) -> pe.Study:
    """Return the study in the file that is open, after putting a variant there.

    Errors name the file.
    """
    scene = opened_scene()
    with from_file():
        if variant is not None:
            bridge.put_variant(scene, bridge.variant_named(scene, variant))
        return bridge.study_from_scene(scene, bpy.context.evaluated_depsgraph_get())


@contextlib.contextmanager
def from_file() -> Iterator[None]:
    """Have errors of the scene name the file that is open."""
    try:
        yield
    except pe.InputError as error:
        raise error.at(bpy.data.filepath) if error.source == "scene" else error from None


def opened_scene() -> bpy.types.Scene:
    """Return the scene of the file that is open; complain when it has nothing of ours."""
    path, scene = bpy.data.filepath, bpy.context.scene
    if not path:
        expected = "an existing .blend file before --command"
        raise pe.InputError("blender", "file", expected, "none opened")
    if scene.perception_entropy.vehicle is None and not bridge.sensor_objects(scene):
        expected = "a vehicle collection and sensors, set in the tab Perception"
        raise pe.InputError(path, f"scene {scene.name!r}", expected, "neither")
    return scene
