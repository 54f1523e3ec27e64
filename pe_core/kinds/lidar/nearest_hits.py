"""Of beams that enter several boxes of a scene, the first one: scene by scene."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .object_definition import BoxHits

Ints = NDArray[np.int64]

NOBODY = np.iinfo(np.int64).max


def nearest_hits(hits: BoxHits, scenes: Ints, beams: int) -> BoxHits:
    """Return what `first_of_scene` does, in some order; `beams` is how many a LiDAR has."""
    scene = scenes[hits.item]
    order = np.argsort(scene, kind="stable")
    starts = np.flatnonzero(np.diff(scene[order], prepend=-1))
    nearest, owner = np.full(beams, np.inf), np.full(beams, NOBODY)
    kept = [np.zeros(0, np.int64)]
    for own in np.split(order, starts[1:]):
        beam = hits.beam[own]
        np.minimum.at(nearest, beam, hits.enter[own])
        first = own[hits.enter[own] == nearest[beam]]
        np.minimum.at(owner, hits.beam[first], hits.item[first])
        kept.append(first[owner[hits.beam[first]] == hits.item[first]])
        nearest[beam], owner[beam] = np.inf, NOBODY
    which = np.concatenate(kept)
    return BoxHits(hits.item[which], hits.beam[which], hits.enter[which])
