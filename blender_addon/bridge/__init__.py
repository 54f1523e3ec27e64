"""The only place that turns Blender's data into the engine's and back."""

from .advanced import clearance_of, perception_of, space_of
from .axles import reference_of, write_reference
from .figures import FigureRule, figure_rule, figures_of, figures_signature, write_figures
from .fingerprint import Fingerprint, fingerprint, signature
from .holds import constrained, free_axes, locked_axes
from .loading import load_into
from .mirroring import (
    follow_mirrors,
    forget_mirrors,
    in_the_middle,
    link_mirror,
    mirror_of,
    mirrored_name,
    mirrored_pose,
    unlink_mirror,
)
from .mount_shapes import LimitBox, bounds_box, mount_faces, mount_key, no_go_boxes
from .mounting import mount_of_row, mounting_of
from .newcomers import SENSORS, drop_foreign_results, unlink_doubles
from .oddities import layers_of, missing_pieces, scene_advice
from .outcome import blender_version, store_outcome, store_warnings, store_words
from .own_sensors import add_own_sensor, forget_own_sensors, sync_own_sensors, table_of
from .passthrough import passthrough_of, write_passthrough
from .placeable import check_placeable, holder_of
from .plain_objects import plain_objects, put_objects, sensors_of_objects
from .prior import focus_rows, prior_from_scene, prior_key
from .records import Record, alike, records_of, records_of_scene, rig_of, write_records
from .restored import restore_result
from .rig import (
    held_pose,
    mounted_on_sensor,
    place_poses,
    place_rig,
    pose_from_numbers,
    pose_of,
    pose_of_matrix,
    possible_sensors,
    rig_from_objects,
    sensor_from_object,
    sensor_objects,
    stand_at,
    view_layer_of,
)
from .scene import check_scene, study_from_scene, study_of_rig, vehicle_of_scene
from .selection import check_choosable, keep_front
from .standing import sensors_collection, shown_collection, stand
from .targets import targets_of
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
from .view_camera import look_back, look_through, tend_views, view_camera

__all__ = [
    "SENSORS",
    "FigureRule",
    "Fingerprint",
    "LimitBox",
    "Record",
    "active_variant",
    "add_own_sensor",
    "add_variant",
    "alike",
    "blender_version",
    "bounds_box",
    "bring_up_to_date",
    "check_choosable",
    "check_placeable",
    "check_scene",
    "check_variants",
    "choose_variant",
    "clearance_of",
    "constrained",
    "copy_score",
    "drop_foreign_results",
    "figure_rule",
    "figures_of",
    "figures_signature",
    "fingerprint",
    "focus_rows",
    "follow_mirrors",
    "forget_mirrors",
    "forget_own_sensors",
    "free_axes",
    "held_pose",
    "holder_of",
    "in_the_middle",
    "keep_front",
    "keep_score",
    "keep_search",
    "layers_of",
    "link_mirror",
    "load_into",
    "locked_axes",
    "look_back",
    "look_through",
    "mirror_of",
    "mirrored_name",
    "mirrored_pose",
    "missing_pieces",
    "mount_faces",
    "mount_key",
    "mount_of_row",
    "mounted_on_sensor",
    "mounting_of",
    "newer_version",
    "no_go_boxes",
    "passthrough_of",
    "perception_of",
    "place_poses",
    "place_rig",
    "plain_objects",
    "pose_from_numbers",
    "pose_of",
    "pose_of_matrix",
    "possible_sensors",
    "prior_from_scene",
    "prior_key",
    "put_objects",
    "put_variant",
    "records_of",
    "records_of_scene",
    "reference_of",
    "restore_result",
    "rig_from_objects",
    "rig_of",
    "same_score",
    "same_variant",
    "scene_advice",
    "score_of",
    "sensor_from_object",
    "sensor_objects",
    "sensors_collection",
    "sensors_of_objects",
    "shown_collection",
    "signature",
    "space_of",
    "stand",
    "stand_at",
    "store_outcome",
    "store_warnings",
    "store_words",
    "study_from_scene",
    "study_of_rig",
    "study_of_variant",
    "sync_own_sensors",
    "table_of",
    "take_scene_s_score",
    "targets_of",
    "tend_views",
    "unlink_doubles",
    "unlink_mirror",
    "variant_dict",
    "variant_named",
    "vehicle_from_collection",
    "vehicle_of_scene",
    "view_camera",
    "view_layer_of",
    "visible_members",
    "write_figures",
    "write_passthrough",
    "write_records",
    "write_reference",
    "write_score",
]
