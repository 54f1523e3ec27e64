"""The document: the only package that converts Blender's data to the engine's, and back.

What is imported here is what other modules of the add-on take from it.
"""

from .apply_variant import apply_records, shown_collection
from .conditions import as_drawn, conditions_of, read_states, shown_motions, shown_state, with_drawn
from .edges import add_edge, edge_objects, edges_of
from .fingerprint import Fingerprint, fingerprint
from .limits import NONE, keep_property, limit_of, limit_property, limits_of, put_limit
from .loading import load_into, write_mount
from .mirroring import (
    clear_mirrors,
    follow_mirrors,
    in_the_middle,
    link_mirror,
    mirror_of,
    mirrored_name,
    mirrored_pose,
    unlink_mirror,
)
from .mounting import bounds_box, mount_faces, mount_key, mount_of_row, no_go_boxes, with_mount
from .own_sensors import add_own_sensor, line_of, read_line, remove_own_sensors, sync_own_sensors
from .prior import focus_regions, prior_from_scene, prior_key
from .requirements import (
    after_of,
    edit_row,
    full_table,
    preset_of,
    requirements_key,
    requirements_of,
    store_verdicts,
    stored_verdict,
    write_row,
)
from .result import (
    Result,
    ResultViews,
    ShownFront,
    begin_with,
    blender_version,
    figures_of_sensor,
    score_from_dict,
    sensor_loss,
    store_outcome,
    store_warnings,
    stored_result,
)
from .rig import (
    TRANSFORM,
    StoredPlacements,
    color_of,
    last_written_pose,
    mounted_on_sensor,
    place_at,
    place_poses,
    place_rig,
    pose_from_numbers,
    pose_of,
    pose_of_matrix,
    restore_transforms,
    sensor_objects,
    transforms,
    view_layer_of,
)
from .scene_diagnostics import check_placeable, missing_data, scene_advice
from .scene_study import (
    check_scene,
    study_as_drawn,
    study_from_scene,
    study_of,
    study_of_rig,
    vehicle_of_scene,
)
from .sensor_colors import assign_colors
from .sensor_records import (
    SensorRecord,
    possible_sensors,
    records_of,
    records_of_scene,
    rig_from_objects,
    rig_of,
    same_sensors,
    sensor_from_object,
    write_records,
)
from .study_table import (
    LARGEST_INT,
    REFERENCE,
    SCORED_PARTS,
    Keys,
    TableData,
    as_typed,
    curve_table,
    document_of,
    has_axles,
    has_mounting_errors,
    has_own_curve,
    in_file,
    new_table,
    property_value,
    put,
    switch_axles,
    switch_mounting_errors,
    switch_own_curve,
    value_at,
    value_of_property,
)
from .time import (
    body_place,
    clear_stale_scenarios,
    frame_rate,
    scenario_of,
    scenario_signatures,
    store_driven,
    write_scenario,
)
from .transform_constraints import holder_of, ticked_axes
from .variant_results import (
    check_choosable,
    copy_scene_score,
    copy_score,
    figures_of,
    figures_signature,
    hardware_note,
    keep_rig,
    keep_search,
    picture_of,
    restore_result,
    same_score,
    score_of,
    store_front,
    store_search,
    store_variant_score,
    store_variant_scores,
    stored_outcome,
    worth_of_differences,
    write_figures,
)
from .variants import (
    activate_variant,
    active_variant,
    add_variant,
    check_variants,
    mark_active,
    matching_variant,
    study_of_variant,
    variant_dict,
    variant_named,
)
from .vehicle import (
    SURROUNDINGS,
    in_surroundings,
    instanced_collections,
    instanced_members,
    layers_of,
    vehicle_from_collection,
    visible_members,
)
from .view_camera import (
    CAMERA_FROM_SENSOR,
    look_back,
    look_through,
    shown_fov,
    update_view_cameras,
    view_camera,
)
