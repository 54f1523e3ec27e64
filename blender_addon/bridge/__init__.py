"""The only place that turns Blender's data into the engine's and back."""

from .newcomers import SENSORS, drop_foreign_results, unlink_doubles
from .outcome import blender_version, store_outcome
from .prior import prior_from_scene
from .rig import (
    mounted_on_sensor,
    place_rig,
    pose_of,
    rig_from_objects,
    sensor_from_object,
    sensor_objects,
    view_layer_of,
)
from .scene import signature, study_from_scene
from .vehicle import vehicle_from_collection, visible_members

__all__ = [
    "SENSORS",
    "blender_version",
    "drop_foreign_results",
    "mounted_on_sensor",
    "place_rig",
    "pose_of",
    "prior_from_scene",
    "rig_from_objects",
    "sensor_from_object",
    "sensor_objects",
    "signature",
    "store_outcome",
    "study_from_scene",
    "unlink_doubles",
    "vehicle_from_collection",
    "view_layer_of",
    "visible_members",
]
