"""The only place that turns Blender's data into the engine's and back."""

from .outcome import blender_version, store_outcome
from .prior import CUSTOM, FROM_BOXES, REGIONS, prior_from_scene
from .rig import place_rig, pose_of, rig_from_scene, sensor_from_object, sensor_objects
from .scene import signature, study_from_scene
from .vehicle import vehicle_from_collection

__all__ = [
    "CUSTOM",
    "FROM_BOXES",
    "REGIONS",
    "blender_version",
    "place_rig",
    "pose_of",
    "prior_from_scene",
    "rig_from_scene",
    "sensor_from_object",
    "sensor_objects",
    "signature",
    "store_outcome",
    "study_from_scene",
    "vehicle_from_collection",
]
