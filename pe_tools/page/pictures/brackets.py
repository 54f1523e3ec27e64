"""Posts in pictures: from the vehicle's nearest surface to a sensor that stands off it."""

from typing import NamedTuple

import numpy as np

import pe_core as pe
from pe_core import scene
from pe_core.base.arrays import Floats

from ... import advice, graphics
from .painted_mesh import PaintedMesh, lathe

GAP_M = 0.03
"""A housing that is nearer to the vehicle stands on it: a pad or a seal fills the gap [m]."""
RADIUS_M = 0.014
STEEL = tuple(graphics.linear_of_srgb(np.array([0.33, 0.35, 0.38])).tolist())


class Post(NamedTuple):
    """What holds a sensor off the body: from a point of the vehicle to the housing's middle [m]."""

    foot: Floats
    head: Floats


def post_of(vehicle: pe.Vehicle, housing: scene.Housing, pose: pe.Pose) -> Post | None:
    """Return the post of a housing at a pose, from the vehicle's point nearest to its middle; None
    where the housing is within `GAP_M` of that point. No score contains it."""
    turn = pose.ground_from_sensor
    head = np.array(pose.position) + scene.rotate(turn, np.array([housing.center]))[0]
    foot = advice.nearest_point(vehicle, head)
    way = head - foot
    length = float(np.sqrt(way @ way))
    along = np.abs(np.array(turn).T @ way) / max(length, 1e-9)
    # How far the housing's box reaches from its middle towards the vehicle.
    reach = float(np.min(np.array(housing.size) / 2.0 / np.maximum(along, 1e-9)))
    return None if length - reach < GAP_M else Post(foot, head)


def painted_post(post: Post) -> PaintedMesh:
    """Return a post as a thin cylinder of steel."""
    way = post.head - post.foot
    length = float(np.sqrt(way @ way))
    upright = lathe([(RADIUS_M, 0.0), (RADIUS_M, length)])
    return PaintedMesh(pe.Vehicle(_turned(way / length, upright) + post.foot), (STEEL,))


def _turned(axis: Floats, triangles: Floats) -> Floats:
    """Return triangles (T, 3, 3) about z turned so that z becomes an axis (3,)."""
    aside = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    aside /= np.sqrt(aside @ aside)
    return np.asarray(triangles @ np.stack([aside, np.cross(axis, aside), axis]))
