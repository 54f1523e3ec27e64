"""``python -m benchmarks.slot_optimum``: the best known of all placements of *six in slots*.

Three LiDARs of one model and three cameras of another take six of sixteen slots: 560 x 286 =
160,160 placements that differ. What a slot's sensor measures depends on no other sensor, so each is
measured once; then all placements are fused by equations 4 to 9 in single precision on a sample of
voxels, and the best of them are scored by the engine on the grid. The count is exact on that
sample; on the grid it is the best of `FINALISTS`, which proves nothing about the others.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import pe_core as pe
from pe_core.metric import BLIND_PRECISION, POINTPILLARS, RTM3D, precision_of

from .search_problems import SPACE, six_in_slots

FOUND = Path(__file__).with_name("slot_optimum.json")
FINALISTS = 40
EVERY = 37
"""One voxel of so many is counted on: 7,784 of 288,000."""
Floats = NDArray[np.float64]


def main() -> int:
    """Count, score the best on the grid, and write what was found."""
    study = six_in_slots()
    measured = _measured(study)
    ranked = sorted(_counted(*measured))
    evaluator = study.evaluator(0)
    scored = [(evaluator.entropy(_rig(study, *slots)), slots) for _, *slots in ranked[:FINALISTS]]
    entropy, slots = min(scored)
    data = {
        "problem": "six in slots",
        "counted": len(ranked),
        "voxels": len(measured[2]),
        "finalists": len(scored),
        "entropy": entropy,
        "slots": [list(each) for each in slots],
    }
    FOUND.write_text(json.dumps(data) + "\n", "utf-8")
    print(data)
    return 0


def _measured(study: pe.Study) -> tuple[Floats, Floats, Floats]:
    """Return m (16, V) of a LiDAR and of a camera in each slot, and the voxels' prior (V,)."""
    axes = [SPACE.centers(k) for k in range(3)]
    centers = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)[::EVERY]
    weights = np.zeros(SPACE.shape)
    for density in study.prior.densities(SPACE):
        weights += density.ground[:, :, None] * density.profile
    weights = weights.reshape(-1)[::EVERY]
    weights[_inside(study, centers)] = 0.0
    kept = weights > 0.0
    centers = centers[kept]
    slots = study.search.mounting.mounts["rack"].slots
    found = []
    for name in ("a", "d"):
        sensors = [study.rig[name].moved(slot.pose) for slot in slots]
        side = SPACE.interval
        found.append(np.array([pe.measure(s, centers, side, study.vehicle) for s in sensors]))
    return found[0], found[1], weights[kept]


def _inside(study: pe.Study, centers: Floats) -> NDArray[np.bool_]:
    """Which voxels are below the vehicle's top, column by column."""
    top = study.vehicle.top(SPACE)
    index = np.floor((centers - np.array(SPACE.origin)) / SPACE.interval).astype(int)
    return centers[:, 2] < top[index[:, 0], index[:, 1]]


def _counted(
    beams: Floats, pixels: Floats, weights: Floats
) -> Iterator[tuple[float, tuple[int, ...], tuple[int, ...]]]:
    """Yield the entropy of each placement, with its slots of LiDARs and of cameras."""
    blind = BLIND_PRECISION
    shares = (weights / weights.sum()).astype(np.float32)
    cameras = precision_of(pixels, RTM3D) - blind
    triples = list(combinations(range(len(beams)), 3))
    added = {t: cameras[list(t)].sum(axis=0).astype(np.float32) for t in triples}
    for lidars in triples:
        own = precision_of(beams[list(lidars)].sum(axis=0), POINTPILLARS)
        own = own.astype(np.float32)
        free = [t for t in triples if not set(t) & set(lidars)]
        for cameras_at in free:
            logs = np.log(own + added[cameras_at])
            yield -float((shares * logs).sum()), lidars, cameras_at


def _rig(study: pe.Study, lidars: tuple[int, ...], cameras: tuple[int, ...]) -> pe.Rig:
    slots = study.search.mounting.mounts["rack"].slots
    return study.rig.with_poses([slots[k].pose for k in (*lidars, *cameras)])


if __name__ == "__main__":
    sys.exit(main())
