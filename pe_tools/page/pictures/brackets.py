"""Posts in pictures: from the vehicle's nearest surface to a sensor that stands off it."""

import numpy as np

import pe_core as pe
from pe_core import scene
from pe_core.base.arrays import Floats
from pe_core.scene.vehicle import closest_points

from ... import graphics
from .painted_mesh import PaintedMesh, lathe

GAP_M = 0.03
"""A housing that is nearer to the vehicle stands on it: a pad or a seal fills the gap [m]."""
RADIUS_M = 0.014
STEEL = tuple(graphics.linear_of_srgb(np.array([0.33, 0.35, 0.38])).tolist())


def bracket(vehicle: pe.Vehicle, housing: scene.Housing, pose: pe.Pose) -> PaintedMesh | None:
    """Return the post that holds a housing at a pose, from the vehicle's point nearest to its
    middle; None where the housing is within `GAP_M` of that point. No score contains it."""
    turn = pose.ground_from_sensor
    middle = np.array(pose.position) + scene.rotate(turn, np.array([housing.center]))[0]
    near = closest_points(middle, vehicle.triangles)
    foot = near[np.argmin(((near - middle) ** 2).sum(axis=1))]
    post = middle - foot
    length = float(np.sqrt(post @ post))
    own = np.abs(np.array(turn).T @ post) / max(length, 1e-9)
    # How far the housing's box reaches from its middle towards the vehicle.
    reach = float(np.min(np.array(housing.size) / 2.0 / np.maximum(own, 1e-9)))
    if length - reach < GAP_M:
        return None
    along = _turned(post / length, lathe([(RADIUS_M, 0.0), (RADIUS_M, length)]))
    return PaintedMesh(pe.Vehicle(along + foot), (STEEL,))


def _turned(axis: Floats, triangles: Floats) -> Floats:
    """Return triangles (T, 3, 3) about z turned so that z becomes an axis (3,)."""
    aside = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    aside /= np.sqrt(aside @ aside)
    return np.asarray(triangles @ np.stack([aside, np.cross(axis, aside), axis]))
