"""A free region held to truth: points inside and close outside it, scored on other voxels.

    python -m benchmarks.region_truth STUDY SENSOR [--loss D] [--points N] [--places N]

It prints the processor time of the coarse and of the fine region, then what share of points loses
more than is allowed. The score of a LiDAR is rough over centimetres, and points are scored on a
sample: a loss is told by its paired error, as surely within what is allowed, surely more, or open.
"""

import argparse
import sys
import time

import numpy as np

from pe_core.scoring import paired_error
from pe_core.search import OwnPlaces
from pe_core.study import Study, load_study
from pe_tools.advice import FreeRegion
from pe_tools.jobs import RegionJob, region_places

OTHER_SHIFT = (0.21, 0.83, 0.47)
"""Of voxels that neither a search nor a region was made of."""
SAMPLES = 262_144
OUTSIDE_M = 0.01
TRIED = 40  # Points that are tried for each one that is close outside
TOLERANCE_M = 1e-4
SURE = 2.0
ENTROPY = ("rig", "", "entropy")


def region_of(study: Study, sensor: str, loss: float | None, places: int | None) -> FreeRegion:
    """Find a region in this process alone; print the processor time of both levels."""
    start = time.process_time()
    job = RegionJob(study, sensor, allowed=loss, count=places, workers=1)
    told = False
    for _ in job:
        if job.found is not None and not told:
            told = True
            print(f"coarse: {time.process_time() - start:.1f} s of processor time")
    print(f"fine: {time.process_time() - start:.1f} s of processor time")
    if job.result is None:
        sys.exit("no region")
    return job.result


def inside(found: FreeRegion, count: int, rng: np.random.Generator) -> np.ndarray:
    """Return random points (count, 3) of a region, by area."""
    triangles = found.patch
    sides = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.sqrt((sides**2).sum(axis=1))
    chosen = triangles[rng.choice(len(triangles), count, p=areas / areas.sum())]
    cuts = np.sort(rng.random((2, count)), axis=0)
    shares = np.stack([cuts[0], cuts[1] - cuts[0], 1.0 - cuts[1]], axis=1)
    points: np.ndarray = (shares[:, :, None] * chosen).sum(axis=1)
    return points


def close_outside(
    found: FreeRegion, places: OwnPlaces, count: int, rng: np.random.Generator
) -> np.ndarray:
    """Return random points (N, 3) of the mount within 1 cm of a region, N at most `count`. Those
    where a rule or a limit ends the region are left out: there the loss is not what ends it."""
    whole = found.corners[found.faces]
    is_free = ~found.forbidden[found.faces].any(axis=1)
    low = found.upper[found.faces].min(axis=1)
    high = found.upper[found.faces].max(axis=1)
    crossed = whole[is_free & (low <= found.allowed) & (high > found.allowed)]
    points = list[np.ndarray]()
    for _ in range(TRIED * count if len(crossed) else 0):
        a, b = np.sort(rng.random(2))
        point = np.array([a, b - a, 1.0 - b]) @ crossed[rng.integers(len(crossed))]
        is_close = TOLERANCE_M < found.off_patch(point) <= OUTSIDE_M
        if is_close and not places.reason(places.at(point)):
            points.append(point)
        if len(points) == count:
            break
    return np.array(points).reshape(-1, 3)


def losses_at(study: Study, places: OwnPlaces, points: np.ndarray) -> np.ndarray:
    """Return losses and their paired standard errors (N, 2) on other voxels than the region's."""
    evaluator = study.evaluator(SAMPLES, shift=OTHER_SHIFT)
    base = evaluator.summary(study.rig)
    rows = []
    for point in points:
        score = evaluator.summary(places.at(point))
        error = paired_error(score.scatter, base.scatter, ENTROPY) or 0.0
        rows.append((score.entropy - base.entropy, error))
    return np.array(rows).reshape(-1, 2)


def told(name: str, rows: np.ndarray, allowed: float) -> str:
    """Return the shares of points that lose more than is allowed, in one line."""
    if not len(rows):
        return f"{name}: no point"
    loss, error = rows.T
    surely_more = np.mean(loss - SURE * error > allowed)
    surely_less = np.mean(loss + SURE * error <= allowed)
    return (
        f"{name}: {len(rows)} points, {np.mean(loss <= allowed):.1%} lose at most {allowed:g}; "
        f"surely within {surely_less:.1%}, surely more {surely_more:.1%}, "
        f"open {1.0 - surely_less - surely_more:.1%}; median error {np.median(error):.4f}"
    )


def main() -> None:
    """Find a region, and print how true it is."""
    parser = argparse.ArgumentParser()
    parser.add_argument("study")
    parser.add_argument("sensor")
    parser.add_argument("--loss", type=float)
    parser.add_argument("--points", type=int, default=200)
    parser.add_argument("--places", type=int)
    args = parser.parse_args()
    study = load_study(args.study)
    found = region_of(study, args.sensor, args.loss, args.places)
    print(f"{found.area:.3f} of {found.mount_area:.3f} m2; {found.extent}")
    places = region_places(study, args.sensor)
    rng = np.random.default_rng(0)
    for name, points in (
        ("inside", inside(found, args.points, rng)),
        ("within 1 cm outside", close_outside(found, places, args.points, rng)),
    ):
        print(told(name, losses_at(study, places, points), found.allowed))


if __name__ == "__main__":
    main()
