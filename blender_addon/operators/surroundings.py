"""A road round the vehicle, with test bodies that can be grabbed: made and removed by one button.

They are objects of a collection of their own, which is never a part of the vehicle.
"""

import math
from typing import Any

import bpy
import numpy as np

from .. import document
from ..caches import vehicle_cache
from ..engine import graphics, requirements
from ..queries import body_query
from ..view import housing
from .declared import operator

NAME = "Surroundings"
Z_M = -0.01
"""Height of the road: just above what pictures show of it farther away."""
HALF_M = (40.0, 20.0)
"""Half the length and width of what is made of the ground."""
ROAD_M = 1.5 * graphics.LANE_M + 0.15
KERB_M = 0.15
KERB_HIGH_M = 0.12
JOINT_M = 0.001
"""Half the road's width; width and height of a kerb, and breadth of its sides seen from above."""
GRID_M = 0.02
STRONG_M = 0.05
NEAR_M = 15.0
"""Width of the lines of the metre grid, and of each fifth; beyond `NEAR_M` only of these."""
MARK_EVERY_M = 10
MARK_M = 0.55
"""Distance of the marks on the road, and the height of their letters."""
GROUND, ROAD, GRID, PAINT, KERB = range(5)
GROUNDS: dict[str, housing.Look] = {
    "PE ground": ((0.075, 0.085, 0.065), 0.0, 0.9),
    "PE road": ((0.035, 0.037, 0.040), 0.0, 0.9),
    "PE grid": ((0.13, 0.14, 0.15), 0.0, 0.9),
    "PE paint": ((0.70, 0.70, 0.68), 0.0, 0.7),
    "PE kerb": ((0.30, 0.30, 0.29), 0.0, 0.8),
}
"""Materials of the ground, in the order of their numbers."""
STANDING: tuple[tuple[str, float, float, float, tuple[float, float, float]], ...] = (
    ("child", 3.0, 1.4, 90.0, (0.90, 0.62, 0.10)),
    ("cone", 4.0, -1.4, 0.0, (0.90, 0.20, 0.03)),
    ("adult", 6.0, -2.6, 90.0, (0.85, 0.40, 0.12)),
    ("cyclist", 9.0, -4.4, 0.0, (0.18, 0.50, 0.20)),
    ("car", 12.0, 3.5, 0.0, (0.12, 0.32, 0.60)),
    ("pole", -6.5, -1.2, 0.0, (0.65, 0.65, 0.60)),
)
"""Test bodies: name, how far ahead of the front and to the left [m], heading [deg], colour."""
WITHOUT_M = 2.35
"""The front where there is no vehicle [m]."""
SIDES = 24


def _made(scene: bpy.types.Scene) -> bpy.types.Collection | None:
    """Return the collection of a scene's surroundings."""
    every = scene.collection.children_recursive
    return next((each for each in every if each.get(document.SURROUNDINGS)), None)


@operator("Add or Remove Surroundings", mode="Surroundings are added in Object Mode")
def surroundings(context: bpy.types.Context) -> str:
    """Put a road with a metre grid and test bodies round the vehicle, or remove them.

    Grab a body: it says which sensors see it, and with how much. Nothing of it is scored"""
    scene = context.scene
    found = _made(scene)
    if found is not None:
        objects = set(found.all_objects)
        data = {each.data for each in objects if each.data is not None}
        bpy.data.batch_remove([*objects, found])
        bpy.data.batch_remove([each for each in data if not each.users])
        return "Surroundings removed"
    made = bpy.data.collections.new(NAME)
    made[document.SURROUNDINGS] = True
    scene.collection.children.link(made)
    for obj in (_road(), *_marks(), _sun()):
        obj.hide_select = True
        made.objects.link(obj)
    vehicle = vehicle_cache.shared.read(scene, context.evaluated_depsgraph_get()).vehicle
    front = WITHOUT_M if vehicle is None else float(vehicle.bounds[1][0])
    for body, ahead, left, heading, color in STANDING:
        obj = bpy.data.objects.new(body, _body_mesh(body, color))
        made.objects.link(obj)
        obj.location = (front + ahead, left, 0.0)
        obj.rotation_euler.z = math.radians(heading)
        obj.lock_location = obj.lock_scale = (False, False, True)
        obj.lock_rotation = (True, True, False)
        obj.perception_entropy.body = body
    context.view_layer.update()
    body_query.query(scene, context.evaluated_depsgraph_get())
    return "Grab a test body: it says which sensors see it"


def _body_mesh(name: str, color: tuple[float, float, float]) -> bpy.types.Mesh:
    """Return a body as it counts: a box that points ahead, or a cylinder; the cone as it is."""
    length, width, height = requirements.BODIES[name].size
    if requirements.BODIES[name].is_round:
        high = 2.0 * height if name == "cone" else height
        rings = [(length / 2.0, 0.0), (length / 2.0, high)]
        if name == "cone":
            rings = [(length, 0.0), (0.05 * length, high)]
        turn = np.arange(SIDES) * (2.0 * math.pi / SIDES)
        around = np.column_stack([np.cos(turn), np.sin(turn)])
        points = [np.column_stack([r * around, np.full(SIDES, z)]) for r, z in rings]
        surface = housing.loft([housing.Ring(each) for each in points])
    else:
        surface = housing.box((length, width, height), length / 2.0, housing.BODY)
    mesh = housing.surface_mesh(name, surface)
    mesh.materials[housing.BODY] = housing.housing_material(f"PE {name}", (color, 0.0, 0.6))
    return mesh


def _road() -> bpy.types.Object:
    """Return ground, lanes and kerbs as one mesh of cells that do not overlap."""
    long, wide = HALF_M
    period = graphics.DASH_M + graphics.GAP_M
    dashes = np.arange(-long, long, period)
    lanes = graphics.LANE_M * np.array([-1.5, -0.5, 0.5, 1.5])
    kerb = np.array([0.0, JOINT_M, KERB_M - JOINT_M, KERB_M]) + ROAD_M
    x = np.unique(np.concatenate([_grid(long), dashes, dashes + graphics.DASH_M, [-long, long]]))
    half = graphics.LINE_M / 2.0
    edges = [_grid(wide), lanes - half, lanes + half, kerb, -kerb, np.array([-wide, wide])]
    y = np.unique(np.concatenate(edges).round(6))
    mid_x, mid_y = ((w[1:] + w[:-1]) / 2.0 for w in (x, y))
    made_of = np.full((len(mid_x), len(mid_y)), GROUND)
    made_of[:, np.abs(mid_y) < ROAD_M] = ROAD
    made_of[_on_grid(mid_x)[:, None] | _on_grid(mid_y)[None]] = GRID
    in_dash = (mid_x + long) % period < graphics.DASH_M
    for lane in lanes:
        whole = abs(lane) > graphics.LANE_M
        made_of[np.ix_(in_dash | whole, np.abs(mid_y - lane) < half)] = PAINT
    made_of[:, (np.abs(mid_y) > ROAD_M) & (np.abs(mid_y) < ROAD_M + KERB_M)] = KERB
    points = np.zeros((len(x), len(y), 3))
    points[..., 0] = x[:, None]
    points[..., 1] = y[None]
    on_top = (np.abs(y) > kerb[0] + JOINT_M / 2.0) & (np.abs(y) < kerb[3] - JOINT_M / 2.0)
    points[..., 2] = np.where(on_top, KERB_HIGH_M, Z_M)
    at = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    faces = np.stack([at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]], axis=-1)
    mesh = bpy.data.meshes.new("Road")
    mesh.from_pydata(points.reshape(-1, 3).tolist(), [], faces.reshape(-1, 4).tolist())
    for name, look in GROUNDS.items():
        mesh.materials.append(housing.housing_material(name, look))
    mesh.polygons.foreach_set("material_index", made_of.ravel())
    return bpy.data.objects.new("Road", mesh)


def _grid(half: float) -> np.ndarray:
    """Return the edges of the lines of the metre grid, out to that distance [m]."""
    lines = np.arange(-half + 1.0, half)
    half_width = _width(lines) / 2.0
    edges = np.concatenate([lines - half_width, lines + half_width])
    return edges[np.tile(half_width > 0.0, 2)]


def _on_grid(middles: np.ndarray) -> np.ndarray:
    """Whether the middles of cells are in lines of the grid."""
    line = np.rint(middles)
    return np.abs(middles - line) < _width(line) / 2.0


def _width(lines: np.ndarray) -> np.ndarray:
    """Return the widths of the lines of the grid; 0 where there is none: far away they blur."""
    near = np.where(np.abs(lines) <= NEAR_M, GRID_M, 0.0)
    return np.where(lines % graphics.STRONG_EVERY == 0, STRONG_M, near)


def _marks() -> list[bpy.types.Object]:
    """Return the distances from the origin, written on the road."""
    found = []
    for x in range(-30, 31, MARK_EVERY_M):
        text = bpy.data.curves.new(f"{x} m", "FONT")
        text.body = f"{x} m"
        text.size = MARK_M
        text.align_x = "CENTER"
        text.materials.append(housing.housing_material("PE paint", GROUNDS["PE paint"]))
        mark = bpy.data.objects.new(f"{x} m", text)
        mark.location = (x + 0.1, graphics.LANE_M, Z_M + 0.004)
        mark.rotation_euler.z = math.radians(-90.0)
        found.append(mark)
    return found


def _sun() -> bpy.types.Object:
    """Return a sun, for renders: in a view its lines would be in the way."""
    light: Any = bpy.data.lights.new("Sun", "SUN")
    light.energy = 3.0
    light.angle = math.radians(0.5)
    sun = bpy.data.objects.new("Sun", light)
    sun.location = (0.0, 0.0, 12.0)
    sun.hide_viewport = True
    sun.rotation_euler = (math.radians(35.0), math.radians(20.0), 0.0)
    return sun
