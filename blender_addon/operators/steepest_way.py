"""*Move to Best Place*: the active sensor goes to the ghost of its best way."""

import bpy
import numpy as np

from .. import document
from ..engine import advice
from ..overlay.layer_cache import shown_of
from ..overlay.layers import WHOLE_RIG
from ..overlay.way_arrow import WayShape
from .declared import Refused, operator

SAME_M = 1e-4
"""A sensor that is farther than this from where its best way was looked for has moved since [m]."""


def shown_way(context: bpy.types.Context) -> advice.SteepestWay | None:
    """Return the best way of the active sensor, as it is shown; None where none is, or it is of
    where the sensor no longer is."""
    obj = context.active_object
    shown = shown_of(context.scene.name, "steepest").get(WHOLE_RIG)
    if obj is None or shown is None or not isinstance(shown.shape, WayShape):
        return None
    found = shown.shape.found
    if found is None or found.sensor != obj.name:
        return None
    away = np.array(obj.matrix_world.translation) - np.array(found.at)
    return found if np.abs(away).max() < SAME_M else None


def _lacks(context: bpy.types.Context) -> str | None:
    found = shown_way(context)
    if found is None or found.better is None:
        return "Best Way shows no better place for the active sensor"
    return None


@operator("Move to Best Place", mode="Sensors are placed in Object Mode", unless=_lacks)
def take_better_place(context: bpy.types.Context) -> str:
    """Move the active sensor to the best place within 20 cm, and with it those that follow it"""
    found = shown_way(context)
    if found is None or found.better is None:
        raise Refused("Best Way shows no better place for the active sensor")
    better = found.better
    document.place_poses(context.scene, better.poses)
    return f"Moved by {better.distance * 100.0:.0f} cm: {better.change:+.3f} nats"
