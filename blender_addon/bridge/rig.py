"""Sensors: objects of the scene to a rig, and a rig's placements back to the objects."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence

import bpy
import numpy as np
from mathutils import Matrix

from ..engine import catalog, geometry, pe, search
from .own_curves import curve_of

SCALE_TOLERANCE = 1e-4
"""How far a sensor's axes may be from unit length and from right angles."""
HELD_POSITION_M = 4e-6
HELD_ROTATION = 2e-6
"""An object this near to where a search put it still stands there: Blender's single precision,
and a chain of parents, move it by less. Both are below half a step of the rounding."""


def sensor_objects(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """All sensors of a scene by name, hidden ones included."""
    found = [obj for obj in scene.objects if obj.perception_entropy.is_sensor]
    return sorted(found, key=lambda obj: obj.name)


def rig_from_objects(objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> pe.Rig:
    """Return the visible ones of a scene's sensors as a rig.

    Raises
    ------
    InputError
        When there is none, or one of them is no possible sensor.
    """
    visible = [obj for obj in objects if obj.visible_get(view_layer=depsgraph.view_layer)]
    if not visible:
        found = f"{len(objects)} hidden" if objects else "none"
        raise pe.InputError("scene", "sensors", "at least one visible sensor", found)
    sensors = [sensor_from_object(obj, depsgraph) for obj in visible]
    try:
        return pe.Rig(sensors)
    except pe.InputError as error:
        raise error.at("scene") from None


def sensor_from_object(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> pe.Sensor:
    """Return one object's model, placement, fusion group and AP curve as a sensor.

    Raises
    ------
    InputError
        When it is no possible sensor; the line names the object.
    """
    settings = obj.perception_entropy
    try:
        model, pose = catalog.load(settings.model), pose_of(obj, depsgraph)
        return pe.Sensor(obj.name, model, pose, settings.fusion or None, curve_of(settings))
    except pe.InputError as error:
        field = f"sensor {obj.name!r}: {error.field}"
        raise pe.InputError("scene", field, error.expected, error.found) from None


def possible_sensors(
    objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph
) -> list[pe.Sensor]:
    """Return the visible ones of a scene's sensors, without those that a score would refuse."""
    found = []
    for obj in objects:
        if obj.visible_get(view_layer=depsgraph.view_layer):
            with contextlib.suppress(pe.InputError):
                found.append(sensor_from_object(obj, depsgraph))
    return found


def pose_of(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> pe.Pose:
    """Return where a sensor stands in the ground frame, rounded as placements are.

    The rounding takes away what single precision adds, so that a study file and the scene hold
    the same numbers.
    """
    ground_from_sensor = np.array(obj.evaluated_get(depsgraph).matrix_world, dtype=float)
    held = held_pose(obj, ground_from_sensor)
    return pose_of_matrix(ground_from_sensor) if held is None else held


def held_pose(obj: bpy.types.Object, ground_from_sensor: np.ndarray) -> pe.Pose | None:
    """Return the pose that was last written to a sensor, while it still stands there."""
    _check_rigid(ground_from_sensor)
    written = pose_from_numbers(obj.perception_entropy.placed)
    return written if _stands_at(ground_from_sensor, written) else None


def pose_of_matrix(ground_from_sensor: np.ndarray) -> pe.Pose:
    """Return a (4, 4) placement as a pose, rounded."""
    rpy = geometry.rpy_from_matrix(ground_from_sensor[:3, :3])
    values = (*ground_from_sensor[:3, 3].tolist(), *rpy)
    return search.pose_from_values(dict(zip(search.AXES, values, strict=True)))


def place_rig(scene: bpy.types.Scene, rig: pe.Rig, start: pe.Rig | None = None) -> list[str]:
    """Put the sensors where a rig has them; return the names of those that are gone.

    Those that stand as they did at the `start` are left alone, wherever they are by now.

    Raises
    ------
    InputError
        When a constraint, a driver or an animation holds a sensor where it is.
    """
    moved = [s for s in rig if start is None or start[s.name].pose != s.pose]
    left = [s.name for s in rig if s not in moved and not _is_sensor(scene.objects.get(s.name))]
    return place_poses(scene, {sensor.name: sensor.pose for sensor in moved}) + left


def place_poses(scene: bpy.types.Scene, poses: Mapping[str, pe.Pose]) -> list[str]:
    """Put sensors, by name, at poses; return the names of those that are gone.

    Raises
    ------
    InputError
        When a constraint, a driver or an animation holds a sensor where it is, or it is another
        file's.
    """
    pairs = [(scene.objects.get(name), pose) for name, pose in poses.items()]
    present = [(obj, pose) for obj, pose in pairs if _is_sensor(obj)]
    layer = view_layer_of(scene)
    # Parents first: a sensor may be mounted on another.
    for obj, pose in sorted(present, key=lambda pair: len(_ancestors(pair[0]))):
        _check_own(obj)
        layer.update()
        stand_at(obj, pose)
    layer.update()
    for obj, pose in present:
        seen = obj.visible_get(view_layer=layer)  # of others Blender does not work out the place
        if seen and not _stands_at(np.array(obj.matrix_world, dtype=float), pose):
            found = "a constraint, driver or animation that holds it"
            raise _not_placed(obj, found)
    return [name for name in poses if not _is_sensor(scene.objects.get(name))]


def stand_at(obj: bpy.types.Object, pose: pe.Pose) -> None:
    """Put an object at a pose, and note it: what single precision makes of it is read as that."""
    _move(obj, pose)
    obj.perception_entropy.placed = (*pose.position, *pose.rotation_deg)


def _check_own(obj: bpy.types.Object) -> None:
    """Complain about a sensor that is linked: its place is its own file's."""
    if obj.library is not None:
        raise _not_placed(obj, f"linked from {obj.library.filepath}")


def _not_placed(obj: bpy.types.Object, found: str) -> pe.InputError:
    expected = "an object that can be placed"
    return pe.InputError("scene", f"sensor {obj.name!r}: placement", expected, found)


def mounted_on_sensor(obj: bpy.types.Object) -> bool:
    """Whether an object rides on a sensor: its housing, which does not stop its own beams."""
    return any(_is_sensor(each) for each in (obj, *_ancestors(obj)))


def _is_sensor(obj: bpy.types.Object | None) -> bool:
    return obj is not None and obj.perception_entropy.is_sensor


def _ancestors(obj: bpy.types.Object) -> list[bpy.types.Object]:
    found = []
    while obj.parent is not None:
        obj = obj.parent
        found.append(obj)
    return found


def view_layer_of(scene: bpy.types.Scene) -> bpy.types.ViewLayer:
    """The view layer in use, or the scene's first when another scene is open."""
    return bpy.context.view_layer if bpy.context.scene == scene else scene.view_layers[0]


def _check_rigid(matrix: np.ndarray) -> None:
    """Complain about a sensor that is scaled, sheared or mirrored, or nowhere at all."""
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
    """Whether a (4, 4) placement is a pose, up to single precision."""
    rotation = np.abs(ground_from_sensor[:3, :3] - pose.ground_from_sensor).max()
    position = np.abs(ground_from_sensor[:3, 3] - np.array(pose.position)).max()
    return bool(rotation < HELD_ROTATION and position < HELD_POSITION_M)


def pose_from_numbers(numbers: Sequence[float]) -> pe.Pose:
    """Pose from x, y, z [m], roll, pitch, yaw [deg] in single precision."""
    position, degrees = numbers[:3], numbers[3:]
    radians = (math.radians(angle) for angle in degrees)
    return search.pose_from_values(dict(zip(search.AXES, (*position, *radians), strict=True)))


def _move(obj: bpy.types.Object, pose: pe.Pose) -> None:
    """Put an object at a pose, whatever its parents."""
    ground_from_sensor = np.eye(4)
    ground_from_sensor[:3, :3] = pose.ground_from_sensor
    ground_from_sensor[:3, 3] = pose.position
    obj.matrix_world = Matrix(ground_from_sensor.tolist())
    plain = obj.parent_type == "OBJECT" and not any(obj.delta_rotation_euler)
    if obj.rotation_mode == "XYZ" and plain:
        # Blender has found the angles in single precision, which is too little near +-90 degrees.
        rotation = (np.linalg.inv(_ground_from_parent(obj)) @ ground_from_sensor)[:3, :3]
        lengths = np.sqrt((rotation**2).sum(axis=0))
        obj.rotation_euler = geometry.rpy_from_matrix(rotation / lengths)


def _ground_from_parent(obj: bpy.types.Object) -> np.ndarray:
    """(4, 4) frame that an object's own location and rotation are in."""
    if obj.parent is None:
        return np.eye(4)
    parent = np.array(obj.parent.matrix_world, dtype=float)
    return parent @ np.array(obj.matrix_parent_inverse, dtype=float)
