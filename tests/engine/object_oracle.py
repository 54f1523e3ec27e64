"""Objects by brute force, written on its own: boxes are triangles, rays meet all of them.

Beams and pixels alike are rays from the sensor; of all triangles, the vehicle's, the object's and,
in traffic, those of the others of its scene, the nearest one that is met takes the ray.
"""

import math

import numpy as np

from pe_tools.verify import oracle
from tests.engine.shapes import BOX_FACES


def corners(objects, item):
    """(8, 3) of one object."""
    own = np.array(list(np.ndindex(2, 2, 2))) - 0.5
    turn = oracle.rotation((0.0, 0.0, objects.yaws[item]))
    return objects.centers[item] + (own * objects.sizes[item]) @ turn.T


def box_triangles(objects, item):
    """(12, 3, 3) of one object."""
    points = corners(objects, item)
    return [points[[f[0], f[k], f[k + 1]]] for f in BOX_FACES for k in (1, 2)]


def taken(origin, directions, objects, vehicle, traffic):
    """Rays that end on each object: (item, distances) of those that take any."""
    blocked = np.full(len(directions), np.inf)
    if vehicle is not None:
        blocked = oracle.first_hits(origin, directions, vehicle.triangles)[0]
    met = [
        oracle.first_hits(origin, directions, box_triangles(objects, i))[0]
        for i in range(len(objects))
    ]
    for item, distance in enumerate(met):
        nearest = blocked
        if traffic:
            for other in np.flatnonzero(objects.scenes == objects.scenes[item]):
                if other != item:
                    nearest = np.minimum(nearest, met[other])
        yield item, distance[np.isfinite(distance) & (distance <= nearest)]


def beams(sensor, azimuths, objects, vehicle, traffic):
    """(N,) beams that end on each object within the range."""
    lidar = sensor.model
    origin = np.array(sensor.pose.position)
    directions = oracle.beam_directions(lidar.elevations, azimuths, sensor.pose.rpy)
    counts = np.zeros(len(objects))
    for item, distance in taken(origin, directions, objects, vehicle, traffic=traffic):
        counts[item] = ((distance >= lidar.min_range) & (distance <= lidar.max_range)).sum()
    return counts


def pixels(sensor, ray_of, finer, objects, vehicle, traffic):
    """(N,) pixels that each object takes, by `finer` by `finer` rays a pixel.

    `ray_of` gives the directions (P, 3), forward, left, up, of places in the picture; NaN of none.
    """
    camera = sensor.model
    across, down = (
        (np.arange(size * finer) + 0.5) / finer for size in (camera.width, camera.height)
    )
    right, below = (w.ravel() for w in np.meshgrid(across, down))
    rays = ray_of(right, below)
    rays = rays[~np.isnan(rays[:, 0])] @ oracle.rotation(sensor.pose.rpy).T
    counts = np.zeros(len(objects))
    for item, distance in taken(
        np.array(sensor.pose.position), rays, objects, vehicle, traffic=traffic
    ):
        counts[item] = len(distance) / finer**2
    return counts


def visible_shares(sensor, ray_of, objects, vehicle, want=10_000):
    """(2, N) shares of the rays to each object that nothing hides, NaN of objects hardly in view.

    The first row: what the vehicle hides is hidden; the second: what the others of its scene do,
    too. Rays through every pixel find the object's part of the picture; about `want` rays to the
    object, evenly spread over that part, decide.
    """
    origin = np.array(sensor.pose.position)
    turn = oracle.rotation(sensor.pose.rpy)
    camera = sensor.model
    shares = np.full((2, len(objects)), np.nan)

    def through(across, down):
        places = [w.ravel() for w in np.meshgrid(across, down)]
        rays = ray_of(places[0], places[1])
        some = np.flatnonzero(~np.isnan(rays[:, 0]))
        return [w[some] for w in places], rays[some] @ turn.T

    def hidden(rays, distance, triangles):
        return first_hits(origin, rays, triangles) < distance

    (across, down), every = through(
        *(np.arange(0.5, size, 1.0) for size in (camera.width, camera.height))
    )
    for item in range(len(objects)):
        own = box_triangles(objects, item)
        met = np.isfinite(first_hits(origin, every, own))
        if met.sum() < 48:
            continue
        finer = math.sqrt(want / met.sum())
        rows = []
        for w, size in ((across[met], camera.width), (down[met], camera.height)):
            finely = np.arange(w.min() - 2.0 + 0.5 / finer, w.max() + 2.0, 1.0 / finer)
            rows.append(finely[(finely > 0.0) & (finely < size)])
        rays = through(*rows)[1]
        distance = first_hits(origin, rays, own)
        rays = rays[np.isfinite(distance)]
        distance = distance[np.isfinite(distance)]
        before = hidden(rays, distance, vehicle.triangles)
        shares[0, item] = 1.0 - before.mean()
        for other in np.flatnonzero(objects.scenes == objects.scenes[item]):
            if other != item:
                before |= hidden(rays, distance, box_triangles(objects, other))
        shares[1, item] = 1.0 - before.mean()
    return shares


def first_hits(origin, rays, triangles):
    """(B,) distance to the nearest triangle; of a triangle only rays into its ball are tested."""
    nearest = np.full(len(rays), np.inf)
    for triangle in np.asarray(triangles) - origin:
        middle = triangle.mean(axis=0)
        away = np.linalg.norm(middle)
        ball = np.linalg.norm(triangle - middle, axis=1).max()
        some = np.arange(len(rays))
        if ball < away:
            some = np.flatnonzero(rays @ middle >= math.sqrt(away**2 - ball**2) - 1e-9)
        if len(some):
            found = oracle.first_hits(np.zeros(3), rays[some], triangle[None])[0]
            nearest[some] = np.minimum(nearest[some], found)
    return nearest


def hull_area(sensor, objects, item):
    """Area of the clipped convex hull of a box's image, None where a corner is not in front."""
    camera = sensor.model
    points = []
    focal = camera.width / (2.0 * math.tan(camera.hfov / 2.0))
    seen = (corners(objects, item) - sensor.pose.position) @ oracle.rotation(sensor.pose.rpy)
    for x, y, z in seen:
        if x <= 0.01:
            return None
        points.append((camera.width / 2.0 - focal * y / x, camera.height / 2.0 - focal * z / x))
    return oracle.outline_area(points, camera.width, camera.height)


def pinhole_rays(camera):
    """Rays of an ideal camera."""
    focal = camera.width / (2.0 * math.tan(camera.hfov / 2.0))

    def ray_of(right, below):
        y = (camera.width / 2.0 - right) / focal
        z = (camera.height / 2.0 - below) / focal
        ray = np.stack([np.ones_like(y), y, z], axis=1)
        return ray / np.linalg.norm(ray, axis=1)[:, None]

    return ray_of


def equidistant_rays(lens, edge):
    """Rays of a fisheye whose radius is the angle times the focal length, up to an edge [rad]."""

    def ray_of(right, below):
        x = (right - lens.cx) / lens.fx
        y = (below - lens.cy) / lens.fy
        theta = np.hypot(x, y)
        scale = np.sin(theta) / np.where(theta > 0.0, theta, 1.0)
        ray = np.stack([np.cos(theta), -x * scale, -y * scale], axis=1)
        ray[theta > edge] = np.nan
        return ray

    return ray_of
