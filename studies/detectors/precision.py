"""Average precision by the distance of centres, as nuScenes has it (arXiv 1903.11027)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ClassScene:
    """Detections and objects of a class in a scene.

    Attributes
    ----------
    scores : (D,) float
    detected : (D, 2) float
        Centres [m].
    objects : (K, 2) float
        Centres [m].
    """

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
    right = np.concatenate([_right(s, distance) for s in scenes])[
        np.argsort(-scores, kind="stable")
    ]
    found = np.cumsum(right)
    precision = found / np.arange(1, len(found) + 1)
    monotone = np.maximum.accumulate(precision[::-1])[::-1]
    return float((monotone * right).sum() / total)


def _right(scene: ClassScene, distance: float) -> NDArray[np.bool_]:
    """Whether each detection of a scene (D,) is right; detections have descending scores."""
    offsets = scene.detected[:, None] - scene.objects[None]
    distances = np.hypot(offsets[..., 0], offsets[..., 1])
    right = np.zeros(len(scene.scores), bool)
    if not len(scene.objects):
        return right
    for k in range(len(right)):
        nearest = int(np.argmin(distances[k]))
        if distances[k, nearest] <= distance:
            right[k] = True
            distances[:, nearest] = np.inf
    return right


def in_ring(scene: ClassScene, inner: float, outer: float) -> ClassScene:
    """Return what of a scene lies in a ring round the origin [m]."""
    detected, objects = (np.hypot(w[:, 0], w[:, 1]) for w in (scene.detected, scene.objects))
    kept = (detected >= inner) & (detected < outer)
    return ClassScene(
        scene.scores[kept],
        scene.detected[kept],
        scene.objects[(objects >= inner) & (objects < outer)],
    )
