"""The sensors of each scene, for panels and views: looked up once after each change.

Panels and 3D views are drawn at every turn of the view, and a lookup takes as long as the scene is
large. A script may call an operator before Blender has noted what the script did: operators look up
sensors themselves (`document.sensor_objects`).
"""

import bpy

from .. import document

_cache: dict[str, list[bpy.types.Object]] = {}
"""Sensors by the scene's name. Objects are held until the next change only; a lookup by name would
take nearly as long as a search of the scene."""


def sensors(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """Return all sensors of a scene by name, hidden ones included."""
    if scene.name not in _cache or not all(map(_is_sensor, _cache[scene.name])):
        _cache[scene.name] = document.sensor_objects(scene)
    return list(_cache[scene.name])


def invalidate(*_: object) -> None:
    """Invalidate the cache; it is rebuilt at the next lookup."""
    _cache.clear()


def _is_sensor(obj: bpy.types.Object) -> bool:
    """Whether an object still exists, and is a sensor."""
    try:
        return obj.perception_entropy.is_sensor
    except ReferenceError:  # a script removed it a moment ago
        return False
