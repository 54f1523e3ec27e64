"""Edges of the vehicle that a user names, to tell the positions of sensors from them."""

import bpy
import numpy as np
from bpy.props import StringProperty

from .. import document, signals
from ..engine import pe, search
from .declared import Refused, operator

POINTS = 2
CURVES = ("MESH", "CURVE")


@operator(
    "Name Edge",
    signal=signals.view_changed,
    name=StringProperty(name="Name", description="Name of the edge", default="edge"),
)
def name_edge(context: bpy.types.Context, name: str) -> str:
    """Name an edge, from which the positions of sensors are told: of the vertices that are selected
    in Edit Mode, or the line or curve beside the vehicle that is selected in Object Mode"""
    scene = context.scene
    taken = [obj.perception_entropy.edge_name for obj in document.edge_objects(scene)]
    if name in taken:
        raise Refused(f"There is an edge {name!r} already: choose another name")
    obj = context.active_object
    if context.mode == "OBJECT":
        vehicle = scene.perception_entropy.vehicle
        parts = set() if vehicle is None else set(vehicle.all_objects)
        if obj is None or obj.type not in CURVES or obj in parts:
            raise Refused(
                "Select vertices of the vehicle in Edit Mode, or a curve beside it, first"
            )
        obj.perception_entropy.edge_name = name
        return f"{obj.name} is the edge {name!r}"
    points = _selected_points(context)
    if len(points) < POINTS:
        raise Refused(f"Select {POINTS} vertices or more first")
    edge = pe.Edge(name, np.round(points, search.POSITION_DECIMALS).tolist())
    document.add_edge(scene, edge)
    return f"Edge {name!r} of {len(edge.points)} vertices"


def _selected_points(context: bpy.types.Context) -> np.ndarray:
    """Return the vertices (N, 3) that are selected in Edit Mode, in the ground frame [m]."""
    points = [np.empty((0, 3))]
    for obj in context.objects_in_mode:
        if obj.type == "MESH":
            obj.update_from_editmode()
            own = [obj.matrix_world @ vertex.co for vertex in obj.data.vertices if vertex.select]
            points.append(np.array(own, dtype=float).reshape(-1, 3))
    return np.concatenate(points)
