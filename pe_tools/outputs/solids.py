"""Fields of view and the blind volume as closed solids: glTF with colours, and an STL of each."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np

from pe_core.base.arrays import Flags, Floats, Ints
from pe_core.scene import PerceptionSpace, Rig, Vehicle
from pe_core.sensors import MeasurementCache, Voxels, kind_of

from ..exchange import Written
from ..graphics import Rgb, sensor_colors_on_paper
from .glb import GlbScene, add_vehicle
from .request import BLIND, NO_RANGE_M, OutputRequest, plain_names
from .scene_gltf import ROOT, STEP
from .solid import NEAREST_M, MountedView, Solid, border, free_solid, mounted_view, star

HIDDEN: Rgb = (0.30, 0.30, 0.30)
FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
HEADER_BYTES = 80
SOLIDS_FILE = "solids.glb"
FREE_ALPHA = 0.25
HIDDEN_ALPHA = 0.5
BLIND_ALPHA = 0.4
BLIND_NAME = "blind_volume"
Coloured = tuple[Solid, Rgb, float]
SIDES = {
    (0, 1): ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
    (0, -1): ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
    (1, 1): ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)),
    (1, -1): ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
    (2, 1): ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
    (2, -1): ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)),
}
"""Corners of a cube's sides by axis and direction, counter-clockwise as seen from outside."""
WITHIN_M = 10.0
HEIGHT_M = 2.5
SIDE_M = 0.25
ANYTHING = 1
"""Saturation count: only whether a voxel is measured matters here."""


def volume(solid: Solid) -> float:
    """Return the volume [m3]: the sum of the signed tetrahedra below its triangles."""
    a, b, c = (solid.points[solid.faces[:, k]] - solid.points[0] for k in range(3))
    return float((a * np.cross(b, c)).sum() / 6.0)


def whole_solid(name: str, view: MountedView) -> Solid:
    """Return the whole field of view, without occlusion by the vehicle."""
    return star(name, view, np.full(len(view.ends), view.reach))


def hidden_solid(name: str, view: MountedView) -> Solid | None:
    """Return the part of a field of view that the vehicle occludes; None if there is none."""
    occluded = view.ends < view.reach - NEAREST_M
    if not occluded[view.faces].any():
        return None
    taken = _without_pinches(view.faces, occluded[view.faces].any(axis=1))
    faces = view.faces[taken]
    count = len(view.directions)
    outer = view.origin + view.directions * view.reach
    inner = view.origin + view.directions * np.minimum(view.ends, view.reach - NEAREST_M)[:, None]
    a, b = border(faces).T
    walls = [np.stack([b, a, a + count], axis=1), np.stack([b, a + count, b + count], axis=1)]
    return Solid.of(
        name, np.vstack([outer, inner]), np.vstack([faces, faces[:, ::-1] + count, *walls])
    )


def _without_pinches(faces: Ints, taken: Flags) -> Flags:
    """Add faces until no two pieces of the taken faces touch in a single point. Walls at such a
    point would have an edge that belongs to four triangles."""
    while True:
        starts = np.bincount(border(faces[taken])[:, 0], minlength=int(faces.max()) + 1)
        more = (starts > 1)[faces].any(axis=1) & ~taken
        if not more.any():
            return taken
        taken = taken | more


def voxel_solid(name: str, cubes: Flags, lowest: Floats, side: float) -> Solid | None:
    """Return the closed surface of cubes (NX, NY, NZ); None if no cube is set. `lowest` (3,) is the
    lowest corner of the grid [m], `side` the length of a cube [m]. No edge may have four faces;
    `joined` makes sure of that."""
    shape = np.array(cubes.shape) + 1
    quads = [_quads(cubes, shape, axis, direction) for axis, direction in SIDES]
    corners = np.concatenate(quads)
    if not len(corners):
        return None
    used, index = np.unique(corners, return_inverse=True)
    a, b, c, d = index.reshape(-1, 4).T
    points = lowest + np.stack(np.unravel_index(used, tuple(shape)), axis=1) * side
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return Solid(name, points, faces)


def _quads(cubes: Flags, shape: Ints, axis: int, direction: int) -> Ints:
    """Return the free faces (Q, 4) in one direction, as indices of lattice points."""
    padded = np.pad(cubes, 1)
    beside = np.roll(padded, -direction, axis)[1:-1, 1:-1, 1:-1]
    cells = np.argwhere(cubes & ~beside)
    corners = cells[:, None] + np.array(SIDES[axis, direction])
    numbers = np.ravel_multi_index(tuple(np.moveaxis(corners, -1, 0)), tuple(shape))
    return np.asarray(numbers, np.int64).reshape(-1, 4)


def joined(cubes: Flags) -> Flags:
    """Fill the lower neighbour cube wherever two cubes touch only along an edge."""
    cubes = cubes.copy()
    while True:
        before = int(cubes.sum())
        for axes in combinations(range(3), 2):
            turned = np.moveaxis(cubes, axes, (0, 1))
            a = turned[:-1, :-1]
            b = turned[1:, :-1]
            c = turned[:-1, 1:]
            d = turned[1:, 1:]
            b |= a & d & ~b & ~c
            a |= b & c & ~a & ~d
        if int(cubes.sum()) == before:
            return cubes


def blind_volume(name: str, rig: Rig, vehicle: Vehicle) -> Solid | None:
    """Return the volume near a vehicle that no sensor sees; None if every voxel is visible."""
    space = _round(vehicle)
    index = np.argwhere(np.ones(space.shape, bool))
    voxels = Voxels(space, index, space.center_of(index))
    measured = MeasurementCache(voxels, vehicle, lambda _: ANYTHING)
    measured.measure(rig)
    visible = np.logical_or.reduce([m > 0 for m in measured.m.values()]).reshape(space.shape)
    inside_vehicle = space.centers(2) < vehicle.top(space)[..., None]
    blind = joined(_squares(~visible | inside_vehicle) & ~inside_vehicle)
    return voxel_solid(name, blind, np.asarray(space.origin), SIDE_M)


def _round(vehicle: Vehicle) -> PerceptionSpace:
    """Return the perception space around a vehicle, aligned with multiples of the cube side."""
    low, high = vehicle.bounds
    first = [math.floor((float(w) - WITHIN_M) / SIDE_M) * SIDE_M for w in low[:2]]
    last = [math.ceil((float(w) + WITHIN_M) / SIDE_M) * SIDE_M for w in high[:2]]
    return PerceptionSpace((first[0], last[0]), (first[1], last[1]), (0.0, HEIGHT_M), SIDE_M)


def _squares(flags: Flags) -> Flags:
    """Keep only the cubes that belong to a horizontal 2 x 2 square of set cubes."""
    squares = flags[:-1, :-1] & flags[1:, :-1] & flags[:-1, 1:] & flags[1:, 1:]
    result = np.zeros_like(flags)
    for i in (slice(None, -1), slice(1, None)):
        for j in (slice(None, -1), slice(1, None)):
            result[i, j] |= squares
    return result


def stl_bytes(solid: Solid) -> bytes:
    """Return a solid as a file; its normals point outwards."""
    corners = solid.points.astype(np.float32)[solid.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).astype(float)
    length = np.sqrt((normal**2).sum(axis=1, keepdims=True))
    facets = np.zeros(len(corners), FACET)
    facets["corners"] = corners
    facets["normal"] = normal / np.where(length > 0.0, length, 1.0)
    # The name last: "solid" is how an ASCII file begins.
    header = f"metres, x forward, y left, z up: {solid.name}".encode("ascii", "replace")
    count = len(facets).to_bytes(4, "little")
    return header[:HEADER_BYTES].ljust(HEADER_BYTES) + count + facets.tobytes()


def write(request: OutputRequest) -> tuple[Written, list[str]]:
    """Return one glTF of all solids and an STL of each, and lines on what is not in them."""
    names, lines = plain_names([sensor.name for sensor in request.study.rig])
    files: dict[str, bytes] = {}
    shown: list[Coloured] = []
    colors = sensor_colors_on_paper(request.study.rig)
    for sensor in request.study.rig:
        reach = request.reach(sensor)
        plain = names[sensor.name]
        view = mounted_view(sensor, request.study.vehicle, reach, STEP)
        if view is None:
            lines.append(f"{sensor.name}: no field of view of a {kind_of(sensor).label} is known")
            continue
        if request.range_m is None and math.isinf(getattr(sensor.model, "max_range", math.inf)):
            ends = f"its solids end at {NO_RANGE_M:g} m (--range)"
            lines.append(f"{sensor.name}: has no range of its own; {ends}")
        files[f"{plain}_field.stl"] = stl_bytes(whole_solid(f"{plain}_field", view))
        free = free_solid(f"{plain}_free", view)
        hidden = hidden_solid(f"{plain}_hidden", view)
        shown.append((free, colors[sensor.name], FREE_ALPHA))
        shown += [(hidden, HIDDEN, HIDDEN_ALPHA)] if hidden is not None else []
    vehicle = request.study.vehicle
    if vehicle is None:
        lines.append("no vehicle: nothing is occluded, and there is no blind volume near it")
    elif (blind := blind_volume(BLIND_NAME, request.study.rig, vehicle)) is None:
        lines.append("no blind volume: all of it is seen")
    else:
        shown.append((blind, BLIND, BLIND_ALPHA))
    files |= {f"{solid.name}.stl": stl_bytes(solid) for solid, _, _ in shown}
    scene = GlbScene()
    nodes = add_vehicle(scene, vehicle, request.study.reference)
    for solid, color, alpha in shown:
        material = scene.add_material(solid.name, color, alpha)
        mesh = scene.add_mesh(solid.name, solid.points, solid.faces, material)
        nodes.append(scene.add_node(solid.name, mesh=mesh, extras={"volume_m3": volume(solid)}))
    return {SOLIDS_FILE: scene.encoded(scene.add_node(ROOT, nodes)), **files}, lines
