"""Average precision by the distance of centres, as nuScenes has it (arXiv 1903.11027)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..results_file import Json
from .casting import RegionObjects
from .plan import StudyPlan
from .scenes import CLASSES

Floats = NDArray[np.float64]


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


def _right(scene: ClassScene, distance: float) -> NDArray[np.bool_]:
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
    plan: StudyPlan, scenes: Sequence[RegionObjects], tested: Sequence[Sequence[ClassScene]]
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
            for ring, limits in plan.precision.rings.items()
        },
        "of_objects_with_beams": _class_aps(plan, met),
        "objects": _counts(tested),
        "objects_with_beams": _counts(met),
    }


def _counts(tested: Sequence[Sequence[ClassScene]]) -> dict[str, int]:
    counts = [sum(len(s.objects) for s in scenes) for scenes in tested]
    return dict(zip(CLASSES, counts, strict=True))


def _class_aps(plan: StudyPlan, tested: Sequence[Sequence[ClassScene]]) -> dict[str, float | None]:
    """Return the AP of each class: the mean over the plan's distances; None without objects."""
    aps: dict[str, float | None] = {}
    for name, scenes in zip(CLASSES, tested, strict=True):
        values = [average_precision(scenes, d) for d in plan.precision.distances_m]
        known = [v for v in values if v is not None]
        aps[name] = round(float(np.mean(known)), 6) if known else None
    return aps
