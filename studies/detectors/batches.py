"""What a detector is given and gives: inputs and targets of scenes, detections and their AP."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pe_core.base import Flags, Floats, Singles

from ..results_file import Json
from .casting import MAX_COUNT, MAX_POINTS, Cloud, RegionObjects, RegionPictures, RegionVoxels
from .plan import Plan, rings_of, shape_of
from .scenes import CLASSES

Mirrors = tuple[bool, bool]

STRIDE = 2
"""As `detector.STRIDE`, without its library."""
LEVELS = np.minimum(np.log2(1.0 + np.arange(MAX_COUNT + 1)) / 4.0, 1.5).astype(np.float32)
"""Input of the network for a count of points."""
SIGMA = 1.0
"""Standard deviation of the peak round a centre in the heat map [cells of the output]."""
REACH = 3
"""The peak is cut off so many cells from the centre's cell."""
MAX_DETECTIONS = 40
"""Detections of a class in a scene."""
MIN_SCORE = 0.01

NEITHER: Mirrors = (False, False)


Inputs = Singles | tuple[Singles, NDArray[np.int32]]
"""Of the network *grid* or that of pictures, or features of points and their pillars (*points*)."""
FEATURES = 4
WHITE = np.float32(255.0)
_STEPS = np.arange(-REACH, REACH + 1)
_PEAK = np.exp(-(_STEPS[:, None] ** 2 + _STEPS**2) / (2.0 * SIGMA**2)).astype(np.float32)


def inputs(scenes: Sequence[RegionObjects], region: Plan, mirrors: Sequence[Mirrors]) -> Inputs:
    """Return the input of the network for scenes of its kind, mirrored along x, y.

    Pictures are not mirrored: a rig's mirror image is another rig.
    """
    if pictures := [scene.pictures for scene in scenes if isinstance(scene, RegionPictures)]:
        return np.stack(pictures).astype(np.float32) / WHITE
    if clouds := [scene for scene in scenes if isinstance(scene, Cloud)]:
        return point_inputs(clouds, region, mirrors)
    return voxel_inputs([s for s in scenes if isinstance(s, RegionVoxels)], region, mirrors)


def point_inputs(
    scenes: Sequence[Cloud], region: Plan, mirrors: Sequence[Mirrors]
) -> tuple[Singles, NDArray[np.int32]]:
    """Return features (B, N, 4) of points, and their pillars (B, N): X * Y for no point.

    Features: x and y from the middle of the pillar [cells], height [m], distance [100 m].
    """
    nx, ny = shape_of(region)
    features = np.zeros((len(scenes), MAX_POINTS, FEATURES), np.float32)
    pillars = np.full((len(scenes), MAX_POINTS), nx * ny, np.int32)
    for k, (scene, mirror) in enumerate(zip(scenes, mirrors, strict=True)):
        x, y, z = (scene.points * np.array([*np.where(mirror, -1.0, 1.0), 1.0])).T
        cells = np.stack([x + region.x_m, y + region.y_m]) / region.cell_m
        i, j = (np.clip(np.floor(c), 0, n - 1) for c, n in zip(cells, (nx, ny), strict=True))
        values = cells[0] - i - 0.5, cells[1] - j - 0.5, z, np.hypot(x, y) / 100.0
        features[k, : len(x)] = np.stack(values, axis=1)
        pillars[k, : len(x)] = i * ny + j
    return features, pillars


def voxel_inputs(
    scenes: Sequence[RegionVoxels], region: Plan, mirrors: Sequence[Mirrors]
) -> Singles:
    """Return the input of the network *grid*, (B, X, Y, layers)."""
    nx, ny = shape_of(region)
    layers = scenes[0].layers
    x = np.zeros((len(scenes), nx * ny * layers), np.float32)
    for k, voxels in enumerate(scenes):
        x[k, voxels.cells] = LEVELS[voxels.counts]
    x = x.reshape(-1, nx, ny, layers)
    for k, (along, across) in enumerate(mirrors):
        x[k] = x[k, :: -1 if along else 1, :: -1 if across else 1]
    return x


def targets(
    scenes: Sequence[RegionObjects], region: Plan, mirrors: Sequence[Mirrors]
) -> tuple[Singles, Singles, Singles]:
    """Return heat maps (B, X, Y, C), offsets (B, X, Y, 2) and cells with centres (B, X, Y).

    Objects that no beam meets are left out.
    """
    nx, ny = (n // STRIDE for n in shape_of(region))
    heat = np.zeros((len(scenes), nx, ny, len(CLASSES)), np.float32)
    offsets = np.zeros((len(scenes), nx, ny, 2), np.float32)
    at = np.zeros((len(scenes), nx, ny), np.float32)
    for k, (voxels, mirror) in enumerate(zip(scenes, mirrors, strict=True)):
        seen = voxels.beams > 0
        signs = np.where(mirror, -1.0, 1.0)
        cells = _in_cells(voxels.centers[seen] * signs, region)
        for center, label in zip(cells, voxels.labels[seen].tolist(), strict=True):
            i, j = (
                int(np.clip(np.floor(c), 0, n - 1)) for c, n in zip(center, (nx, ny), strict=True)
            )
            _add_peak(heat[k, :, :, label], i, j)
            offsets[k, i, j] = center - (i + 0.5, j + 0.5)
            at[k, i, j] = 1.0
    return heat, offsets, at


def _in_cells(centers: np.ndarray, region: Plan) -> np.ndarray:
    return (centers + np.array([region.x_m, region.y_m])) / (STRIDE * region.cell_m)


def _add_peak(heat: Singles, i: int, j: int) -> None:
    """Raise a class's heat map (X, Y) round a cell."""
    x0 = max(i - REACH, 0)
    x1 = min(i + REACH + 1, heat.shape[0])
    y0 = max(j - REACH, 0)
    y1 = min(j + REACH + 1, heat.shape[1])
    peak = _PEAK[x0 - i + REACH : x1 - i + REACH, y0 - j + REACH : y1 - j + REACH]
    np.maximum(heat[x0:x1, y0:y1], peak, out=heat[x0:x1, y0:y1])


def detections(
    heat: np.ndarray, offsets: np.ndarray, region: Plan
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the detections of a scene, by class: scores (N,), descending, and centres (N, 2) [m].

    A detection is a cell whose probability, `heat` (X, Y, C), is the highest of its neighbours.
    """
    padded = np.pad(heat, ((1, 1), (1, 1), (0, 0)), constant_values=-1.0)
    nx, ny, classes = heat.shape
    highest = np.max([padded[i : i + nx, j : j + ny] for i in range(3) for j in range(3)], axis=0)
    peaks = (heat == highest) & (heat >= MIN_SCORE)
    found = []
    for c in range(classes):
        i, j = np.nonzero(peaks[:, :, c])
        scores = heat[i, j, c]
        best = np.argsort(-scores, kind="stable")[:MAX_DETECTIONS]
        i = i[best]
        j = j[best]
        cells = np.column_stack([i, j]) + 0.5 + offsets[i, j]
        centers = cells * (STRIDE * region.cell_m) - (region.x_m, region.y_m)
        found.append((scores[best], centers))
    return found


# Average precision by the distance of centres, as nuScenes has it (arXiv 1903.11027).


@dataclass(frozen=True, slots=True)
class ClassScene:
    """A class in a scene: scores of detections (D,), centres of these and of objects (., 2) [m]."""

    scores: Floats
    detected: Floats
    objects: Floats


def average_precision(scenes: Sequence[ClassScene], distance: float) -> float | None:
    """Return the AP of a class; None if there is no object.

    Detections are taken by descending score (equal ones in the order of the scenes). Each takes
    the nearest object of its scene that is not taken; it is right if that is within `distance` [m].
    """
    total = sum(len(s.objects) for s in scenes)
    if not total:
        return None
    scores = np.concatenate([s.scores for s in scenes])
    right = np.concatenate([_right(s, distance) for s in scenes])
    right = right[np.argsort(-scores, kind="stable")]
    precision = np.cumsum(right) / np.arange(1, len(right) + 1)
    monotone = np.maximum.accumulate(precision[::-1])[::-1]
    return float((monotone * right).sum() / total)


def _right(scene: ClassScene, distance: float) -> Flags:
    """Whether each detection of a scene (D,) is right; detections have descending scores."""
    offsets = scene.detected[:, None] - scene.objects[None]
    distances = np.hypot(offsets[..., 0], offsets[..., 1])
    right = np.zeros(len(scene.scores), bool)
    for k in range(len(right) if len(scene.objects) else 0):
        nearest = int(np.argmin(distances[k]))
        if distances[k, nearest] <= distance:
            right[k] = True
            distances[:, nearest] = np.inf
    return right


def in_ring(scene: ClassScene, inner: float, outer: float) -> ClassScene:
    """Return what of a scene lies in a ring round the origin [m]."""
    detected, objects = (np.hypot(w[:, 0], w[:, 1]) for w in (scene.detected, scene.objects))
    kept = (detected >= inner) & (detected < outer)
    there = scene.objects[(objects >= inner) & (objects < outer)]
    return ClassScene(scene.scores[kept], scene.detected[kept], there)


def results(
    plan: Plan, scenes: Sequence[RegionObjects], tested: Sequence[Sequence[ClassScene]]
) -> Json:
    """Return the results of a test: AP of all classes, by class, by ring, of objects with beams."""
    met = [
        [
            ClassScene(s.scores, s.detected, s.objects[v.beams[v.labels == c] > 0])
            for s, v in zip(of_class, scenes, strict=True)
        ]
        for c, of_class in enumerate(tested)
    ]
    by_class = _class_aps(plan, tested)
    return {
        "ap": round(float(np.mean([ap or 0.0 for ap in by_class.values()])), 6),
        "by_class": by_class,
        "by_ring": {
            ring: _class_aps(plan, [[in_ring(s, *limits) for s in scenes] for scenes in tested])
            for ring, limits in rings_of(plan).items()
        },
        "of_objects_with_beams": _class_aps(plan, met),
        "objects": _counts(tested),
        "objects_with_beams": _counts(met),
    }


def _counts(tested: Sequence[Sequence[ClassScene]]) -> dict[str, int]:
    counts = [sum(len(s.objects) for s in scenes) for scenes in tested]
    return dict(zip(CLASSES, counts, strict=True))


def _class_aps(plan: Plan, tested: Sequence[Sequence[ClassScene]]) -> dict[str, float | None]:
    """Return the AP of each class: the mean over the plan's distances; None without objects."""
    aps: dict[str, float | None] = {}
    for name, scenes in zip(CLASSES, tested, strict=True):
        values = [average_precision(scenes, d) for d in plan.precision.distances_m]
        known = [v for v in values if v is not None]
        aps[name] = round(float(np.mean(known)), 6) if known else None
    return aps
