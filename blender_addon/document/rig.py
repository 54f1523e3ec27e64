"""Sensors: read objects of the scene as the engine's rig, and write the poses of a rig to them."""

import math
from collections.abc import Mapping, Sequence

import bpy
import numpy as np
from bpy.types import Depsgraph, Object, Scene, ViewLayer
from mathutils import Matrix

from ..engine import geometry, pe, search
from .study_table import value_at

COLOR = ("color",)
SCALE_TOLERANCE = 1e-4
"""How far a sensor's axes may be from unit length and from right angles."""
HELD_POSITION_M = 4e-6
HELD_ROTATION = 2e-6
"""An object this near to its last written pose has not moved: single precision and a chain of
parents move it by less. Both tolerances are below half a step of the rounding."""
TRANSFORM = ("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale")


def sensor_objects(scene: Scene) -> list[Object]:
    """Return all sensors of a scene, hidden ones included: in the order of an imported study, which
    the bits of a search depend on, then by name."""
    sensors = [obj for obj in scene.objects if obj.perception_entropy.is_sensor]
    return sorted(sensors, key=lambda obj: (obj.perception_entropy.order, obj.name))


def color_of(obj: Object) -> str | None:
    """Return the colour of a sensor, such as "#5fb8f7"; None before it has one."""
    settings = obj.perception_entropy
    return value_at(settings.table, COLOR) if settings.color_of else None


def pose_of(obj: Object, depsgraph: Depsgraph) -> pe.Pose:
    """Return the pose of a sensor in the ground frame, rounded as placements are. Rounding removes
    the error of single precision, so that a study file and the scene hold the same numbers."""
    ground_from_sensor = np.array(obj.evaluated_get(depsgraph).matrix_world, dtype=float)
    held = last_written_pose(obj.perception_entropy.placed, ground_from_sensor)
    return pose_of_matrix(ground_from_sensor) if held is None else held


def last_written_pose(placed: Sequence[float], ground_from_sensor: np.ndarray) -> pe.Pose | None:
    """Return the pose that was last written to a sensor, as numbers; None if the sensor has moved
    since."""
    _check_rigid(ground_from_sensor)
    written = pose_from_numbers(placed)
    return written if _stands_at(ground_from_sensor, written) else None


def pose_of_matrix(ground_from_sensor: np.ndarray) -> pe.Pose:
    """Return a (4, 4) matrix, ground from sensor, as a rounded pose."""
    rpy = geometry.rpy_from_matrix(ground_from_sensor[:3, :3])
    values = (*ground_from_sensor[:3, 3].tolist(), *rpy)
    return search.pose_from_values(dict(zip(search.AXES, values, strict=True)))


def place_rig(scene: Scene, rig: pe.Rig, start: pe.Rig | None = None) -> list[str]:
    """Place the scene's sensors as in a rig; return the names of sensors that no longer exist.

    Sensors with the same pose in the rig `start` are not moved, wherever they are now.

    `InputError` when a constraint, a driver or an animation holds a sensor where it is.
    """
    moved = [s for s in rig if start is None or start[s.name].pose != s.pose]
    left = [s.name for s in rig if s not in moved and not _is_sensor(scene.objects.get(s.name))]
    return place_poses(scene, {sensor.name: sensor.pose for sensor in moved}) + left


StoredPlacements = dict[str, tuple[dict[str, tuple[float, ...]], tuple[float, ...]]]
"""Of sensors, by name: their transforms by property, and the poses that were last written."""


def transforms(scene: Scene) -> StoredPlacements:
    """Return what places the sensors of a scene, as Blender stores it."""
    return {
        obj.name: (
            {field: tuple(getattr(obj, field)) for field in TRANSFORM},
            tuple(obj.perception_entropy.placed),
        )
        for obj in sensor_objects(scene)
    }


def restore_transforms(scene: Scene, before: StoredPlacements) -> None:
    """Place the sensors of a scene as they were, to the bit."""
    for name, (transform, placed) in before.items():
        if (obj := scene.objects.get(name)) is not None:
            for field, value in transform.items():
                setattr(obj, field, value)
            obj.perception_entropy.placed = placed
    view_layer_of(scene).update()


def place_poses(scene: Scene, poses: Mapping[str, pe.Pose]) -> list[str]:
    """Place sensors, by name, at poses; return the names of sensors that no longer exist.
    `InputError` when a constraint, a driver or an animation holds a sensor where it is, or it is
    another file's."""
    present: list[tuple[Object, pe.Pose]] = [
        (scene.objects[name], pose)
        for name, pose in poses.items()
        if _is_sensor(scene.objects.get(name))
    ]
    layer = view_layer_of(scene)
    # Parents first: a sensor may be mounted on another.
    for obj, pose in sorted(present, key=lambda pair: len(_ancestors(pair[0]))):
        if obj.library is not None:
            raise _not_placed(obj, f"linked from {obj.library.filepath}")
        layer.update()
        place_at(obj, pose)
    layer.update()
    for obj, pose in present:
        seen = obj.visible_get(view_layer=layer)  # Blender evaluates visible objects only
        if seen and not _stands_at(np.array(obj.matrix_world, dtype=float), pose):
            found = "a constraint, driver or animation that holds it"
            raise _not_placed(obj, found)
    return [name for name in poses if not _is_sensor(scene.objects.get(name))]


def place_at(obj: Object, pose: pe.Pose) -> None:
    """Place an object at a pose; store the pose, because single precision would round it."""
    _move(obj, pose)
    obj.perception_entropy.placed = (*pose.position, *pose.rotation_deg)


def _not_placed(obj: Object, found: str) -> pe.InputError:
    expected = "an object that can be placed"
    return pe.InputError("scene", f"sensor {obj.name!r}: placement", expected, found)


def mounted_on_sensor(obj: Object) -> bool:
    """Whether an object is mounted on a sensor, as a housing is; it occludes no beam."""
    return any(_is_sensor(ancestor) for ancestor in (obj, *_ancestors(obj)))


def _is_sensor(obj: Object | None) -> bool:
    return obj is not None and obj.perception_entropy.is_sensor


def _ancestors(obj: Object) -> list[Object]:
    ancestors = []
    while obj.parent is not None:
        obj = obj.parent
        ancestors.append(obj)
    return ancestors


def view_layer_of(scene: Scene) -> ViewLayer:
    """Return the view layer in use; the scene's first one when another scene is open."""
    return bpy.context.view_layer if bpy.context.scene == scene else scene.view_layers[0]


def _check_rigid(matrix: np.ndarray) -> None:
    """Raise `InputError` for a matrix that scales, shears or mirrors, or is not finite."""
    if not np.isfinite(matrix).all():
        raise pe.InputError("object", "placement", "finite numbers", "NaN or infinity")
    axes = matrix[:3, :3]
    lengths = np.sqrt((axes**2).sum(axis=0))
    if np.abs(lengths - 1.0).max() > SCALE_TOLERANCE:
        expected = "1 in each direction: Ctrl-A > Scale (its drawn size is its display size)"
        found = ", ".join(f"{length:.4g}" for length in lengths)
        raise pe.InputError("object", "scale", expected, found)
    if np.abs(axes.T @ axes - np.eye(3)).max() > SCALE_TOLERANCE:
        raise pe.InputError("object", "rotation", "axes at right angles", "shear from its parent")
    if np.linalg.det(axes) < 0.0:
        raise pe.InputError("object", "scale", "no mirroring: Ctrl-A > Scale", "a negative scale")


def _stands_at(ground_from_sensor: np.ndarray, pose: pe.Pose) -> bool:
    """Whether a (4, 4) matrix equals a pose, up to single precision."""
    rotation = np.abs(ground_from_sensor[:3, :3] - pose.ground_from_sensor).max()
    position = np.abs(ground_from_sensor[:3, 3] - np.array(pose.position)).max()
    return bool(rotation < HELD_ROTATION and position < HELD_POSITION_M)


def pose_from_numbers(numbers: Sequence[float]) -> pe.Pose:
    """Return a pose from x, y, z [m], roll, pitch, yaw [deg] in single precision."""
    position = numbers[:3]
    degrees = numbers[3:]
    radians = (math.radians(angle) for angle in degrees)
    return search.pose_from_values(dict(zip(search.AXES, (*position, *radians), strict=True)))


def _move(obj: Object, pose: pe.Pose) -> None:
    """Set the transform of an object to a pose, whatever its parents."""
    ground_from_sensor = np.eye(4)
    ground_from_sensor[:3, :3] = pose.ground_from_sensor
    ground_from_sensor[:3, 3] = pose.position
    obj.matrix_world = Matrix(ground_from_sensor.tolist())
    plain = obj.parent_type == "OBJECT" and not any(obj.delta_rotation_euler)
    if obj.rotation_mode == "XYZ" and plain:
        # Blender computes the angles in single precision, which is too coarse near +-90 degrees.
        rotation = (np.linalg.inv(_ground_from_parent(obj)) @ ground_from_sensor)[:3, :3]
        lengths = np.sqrt((rotation**2).sum(axis=0))
        obj.rotation_euler = geometry.rpy_from_matrix(rotation / lengths)


def _ground_from_parent(obj: Object) -> np.ndarray:
    """Return the (4, 4) frame in which an object's location and rotation are given."""
    if obj.parent is None:
        return np.eye(4)
    parent = np.array(obj.parent.matrix_world, dtype=float)
    return parent @ np.array(obj.matrix_parent_inverse, dtype=float)
