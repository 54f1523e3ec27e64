"""The only place that turns Blender's data into the engine's and back."""

from .fingerprint import Fingerprint, fingerprint, signature
from .newcomers import SENSORS, drop_foreign_results, unlink_doubles
from .oddities import missing_pieces, scene_advice
from .outcome import blender_version, store_outcome, store_warnings, store_words
from .placeable import check_placeable
from .prior import prior_from_scene, prior_key
from .records import Record, alike, records_of, records_of_scene, rig_of, write_records
from .rig import (
    mounted_on_sensor,
    place_rig,
    pose_of,
    possible_sensors,
    rig_from_objects,
    sensor_from_object,
    sensor_objects,
    view_layer_of,
)
from .scene import check_scene, study_from_scene
from .standing import sensors_collection, stand
from .variants import (
    active_variant,
    add_variant,
    check_variants,
    choose_variant,
    copy_score,
    keep_score,
    keep_search,
    put_variant,
    same_score,
    same_variant,
    score_of,
    study_of_variant,
    take_scene_s_score,
    variant_dict,
    variant_named,
    write_score,
)
from .vehicle import vehicle_from_collection, visible_members
from .versions import bring_up_to_date, newer_version

__all__ = [
    "SENSORS",
    "Fingerprint",
    "Record",
    "active_variant",
    "add_variant",
    "alike",
    "blender_version",
    "bring_up_to_date",
    "check_placeable",
    "check_scene",
    "check_variants",
    "choose_variant",
    "copy_score",
    "drop_foreign_results",
    "fingerprint",
    "keep_score",
    "keep_search",
    "missing_pieces",
    "mounted_on_sensor",
    "newer_version",
    "place_rig",
    "pose_of",
    "possible_sensors",
    "prior_from_scene",
    "prior_key",
    "put_variant",
    "records_of",
    "records_of_scene",
    "rig_from_objects",
    "rig_of",
    "same_score",
    "same_variant",
    "scene_advice",
    "score_of",
    "sensor_from_object",
    "sensor_objects",
    "sensors_collection",
    "signature",
    "stand",
    "store_outcome",
    "store_warnings",
    "store_words",
    "study_from_scene",
    "study_of_variant",
    "take_scene_s_score",
    "unlink_doubles",
    "variant_dict",
    "variant_named",
    "vehicle_from_collection",
    "view_layer_of",
    "visible_members",
    "write_records",
    "write_score",
]
