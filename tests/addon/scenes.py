"""Small scenes to test on."""

from pathlib import Path

import bpy
import numpy as np

from blender_addon import document
from blender_addon.overlay import scheduler
from blender_addon.overlay.layer_cache import shown
from blender_addon.overlay.layers import LAYERS
from pe_tools.graphics import LayerShape

ASSETS = Path(__file__).resolve().parents[2] / "blend_assets"

CUBE = (
    (-1, -1, -1),
    (1, -1, -1),
    (1, 1, -1),
    (-1, 1, -1),
    (-1, -1, 1),
    (1, -1, 1),
    (1, 1, 1),
    (-1, 1, 1),
)
CUBE_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def cube_mesh(half_size=(1.0, 1.0, 1.0)) -> bpy.types.Mesh:
    """Return a box about the origin, its faces looking outwards."""
    mesh = bpy.data.meshes.new("box")
    mesh.from_pydata((np.array(CUBE) * half_size).tolist(), [], CUBE_FACES)
    return mesh


def add_collection(parent, name: str) -> bpy.types.Collection:
    """Return a new collection below another one."""
    made = bpy.data.collections.new(name)
    parent.children.link(made)
    return made


def add_box(collection, name: str, half_size=(1.0, 1.0, 1.0), **settings) -> bpy.types.Object:
    """Return a new box in a collection; settings are attributes of the object."""
    box = bpy.data.objects.new(name, cube_mesh(half_size))
    collection.objects.link(box)
    for key, value in settings.items():
        setattr(box, key, value)
    return box


def add_car(scene) -> bpy.types.Collection:
    """Return a car of two boxes, 4 m long and 1.5 m high, chosen as the scene's vehicle."""
    car = add_collection(scene.collection, "Car")
    add_box(car, "body", (2.0, 0.9, 0.35), location=(0.0, 0.0, 0.55))
    add_box(car, "cabin", (1.0, 0.8, 0.3), location=(-0.3, 0.0, 1.2))
    scene.perception_entropy.vehicle = car
    return car


def add_sensor(name: str, model: str = "Pandar64", **settings) -> bpy.types.Object:
    """Return a new sensor; settings are attributes of the object."""
    assert bpy.ops.pe.add_sensor(model=model) == {"FINISHED"}
    sensor = bpy.context.object
    sensor.name = name
    for key, value in settings.items():
        setattr(sensor, key, value)
    bpy.context.view_layer.update()
    return sensor


def add_mount(scene, name: str, *parts: bpy.types.Object, **settings):
    """Return a new mount of a scene, made of these parts; settings are its own."""
    row = scene.perception_entropy.mounts.add()
    row.name = name
    for part in parts:
        row.parts.add().part = part
    for key, value in settings.items():
        setattr(row, key, value)
    return row


def paint(obj: bpy.types.Object, group: str, weight) -> None:
    """Paint a vertex group: the weight of each vertex by its place in the object's frame."""
    painted = obj.vertex_groups.get(group) or obj.vertex_groups.new(name=group)
    for vertex in obj.data.vertices:
        painted.add([vertex.index], weight(vertex.co), "REPLACE")


def depsgraph() -> bpy.types.Depsgraph:
    """Return the evaluated scene, up to date."""
    return bpy.context.evaluated_depsgraph_get()


def seen_rig(car) -> bpy.types.Scene:
    """Return a car with a LiDAR, and now a camera at its front, all layers shown but the best way
    of a sensor, which scores many rigs."""
    add_sensor("eye", "Camera 60 deg", location=(2.0, 0.0, 1.0))
    add_mount(car, "cabin", bpy.data.objects["cabin"])
    settings = car.perception_entropy
    view = car.perception_entropy.view
    settings.space_x = (-30.0, 30.0)
    settings.space_y = (-15.0, 15.0)
    for layer in LAYERS:
        setattr(view, f"show_{layer.name}", layer.name != "steepest")
    view.beams_of = "ALL"
    car.perception_entropy.axles_known = True
    bpy.ops.pe.add_row(rows="focus", kind="front")
    bpy.ops.pe.add_row(rows="requirements", kind="OWN")
    bpy.ops.pe.add_row(rows="scenarios", kind="cyclist_from_right")
    return car


def drawn(scene) -> dict[str, dict[str, LayerShape]]:
    """Return what the 3D view shows of a scene: shapes by layer, then by sensor."""
    scheduler.update()
    return {
        layer: {n: item.shape for n, item in items.items()}
        for (of, layer), items in shown.items()
        if of == scene.name
    }


def study():
    """Return the study of the scene that is open."""
    return document.study_from_scene(bpy.context.scene, depsgraph())


def shipped_study(name: str):
    """Open one of the example vehicles; return it with its sensors."""
    bpy.ops.wm.open_mainfile(filepath=str(ASSETS / f"{name}.blend"))
    return study()


def vehicle(collection):
    """Return a collection as the engine's vehicle."""
    return document.vehicle_from_collection(collection, depsgraph())


def edges_of(triangles: np.ndarray) -> list[tuple[int, int]]:
    """Directed edges of (F, 3, 3) triangles, three a face; corners join at 0.01 mm."""
    _, corner = np.unique(np.round(triangles.reshape(-1, 3), 5) + 0.0, axis=0, return_inverse=True)
    faces = corner.reshape(-1, 3)
    pairs = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1)
    return [(a, b) for a, b in pairs.reshape(-1, 2).tolist()]


def open_edges(triangles: np.ndarray) -> int:
    """How many edges lack an opposite one, or come twice."""
    edges = edges_of(triangles)
    have = set(edges)
    return sum((b, a) not in have for a, b in edges) + len(edges) - len(have)


def sharpest_fold(triangles: np.ndarray, least_area: float = 5e-6) -> float:
    """Least cosine between faces that share an edge, of those above an area [m^2]."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    face = {edge: i // 3 for i, edge in enumerate(edges_of(triangles)) if size[i // 3] > least_area}
    pairs = np.array([(i, face[q, p]) for (p, q), i in face.items() if (q, p) in face])
    return float((normal[pairs].prod(axis=1).sum(axis=1) / size[pairs].prod(axis=1)).min())
