"""Small shapes and sensors that the tests share."""

import math

import numpy as np

import pe_core as pe

BOX_FACES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def box(low, high):
    """(12, 3, 3) triangles of an axis-aligned box."""
    ends = np.array([low, high], dtype=float)
    corners = np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i, j, k in np.ndindex(2, 2, 2)])
    return np.array(
        [corners[[f[0], f[i], f[i + 1]]] for f in BOX_FACES for i in (1, 2)], dtype=float
    )


def refined(triangles, times):
    """The same surface with each triangle cut in four, `times` times."""
    for _ in range(times):
        a = triangles[:, 0]
        b = triangles[:, 1]
        c = triangles[:, 2]
        ab = (a + b) / 2
        bc = (b + c) / 2
        ca = (c + a) / 2
        corners = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        triangles = np.concatenate([np.stack(t, axis=1) for t in corners])
    return triangles


def box_car(times=0):
    """A 4.6 x 1.8 x 1.4 m car of two boxes: body and cabin."""
    body = box((-2.3, -0.9, 0.2), (2.3, 0.9, 0.9))
    cabin = box((-1.5, -0.7, 0.8), (0.8, 0.7, 1.4))
    triangles = [refined(body, times), refined(cabin, times)]
    parts = np.repeat([0, 1], [len(t) for t in triangles]).astype(np.int32)
    return pe.Vehicle(np.concatenate(triangles), parts, ("body", "cabin"))


def small_lidar(channels=16, azimuths=180, **options):
    """A LiDAR of few beams."""
    elevations = np.radians(np.linspace(-25.0, 15.0, channels))
    return pe.Lidar("small", elevations, azimuths, options.pop("max_range", 60.0), **options)


def lidar_on_roof(model=None, position=(-0.43, 0.0, 1.8), rotation=(0.0, 0.0, 0.0), name="roof"):
    """A LiDAR, the paper's Pandar64 by default, above the roof."""
    model = model or pe.catalog.load("Pandar64")
    return pe.Sensor(name, model, pe.Pose.from_degrees(position, rotation))


def roof_rig(channels=16, azimuths=180):
    """A rig of one LiDAR of few beams."""
    return pe.Rig([lidar_on_roof(small_lidar(channels, azimuths))])


def camera(hfov_deg=60.0, position=(1.0, 0.0, 1.5), rotation=(0.0, 0.0, 0.0), name="camera"):
    """A 1920 x 1080 camera looking ahead."""
    model = pe.Camera("camera", 1920, 1080, math.radians(hfov_deg))
    return pe.Sensor(name, model, pe.Pose.from_degrees(position, rotation))


def small_space(interval=0.5):
    """A space of a few ten thousand voxels."""
    return pe.PerceptionSpace((-20, 20), (-10, 10), (0, 5), interval)


def tilted_rig():
    """A LiDAR and a camera that look aside, for files of other programs."""
    lidar = lidar_on_roof(small_lidar(), rotation=(4.0, -7.0, 100.0))
    return pe.Rig([lidar, camera(70.0, (1.0, 0.5, 1.2), (5.0, 20.0, -130.0), name="eye")])


def car_study(rig, **fields):
    """A study of sensors on the box car, in the small space."""
    return pe.Study(rig, box_car(), small_space(), **fields)


def short_search(free, **given):
    """A random search of a few placements on a thousand voxels."""
    own = {"limits": {}, "seed": 3, "samples": 1024, "method": "random"}
    return pe.Search(free, **own | {"schedule": pe.Schedule(candidates=2)} | given)
