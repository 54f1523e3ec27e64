"""Objects measured again after a move: alone and in traffic."""

from __future__ import annotations

import numpy as np

import pe_core as pe
from pe_core.prior import ROAD_CLASSES
from pe_core.sensors import ObjectMeasurementCache

from .problems import car, four_on_car, moved_a_little, plain_study
from .timing import Timing, best_of_processor, peak_mb

ALONE = 20_000
SCENES = 200
IN_A_SCENE = 20
SAMPLES = 262_144
A_PART = 100
MOVES = 8


def objects_free() -> Timing:
    """A Pandar64 moved, against the definition on a hundredth of the objects."""
    objects = _objects(ALONE)
    (sensor,) = plain_study(None).rig
    ours = _after_moves(pe.Rig([sensor]), objects, None, False)
    peak = peak_mb()
    some = objects.some(np.arange(0, ALONE, A_PART))
    theirs = best_of_processor(lambda: pe.measure_objects(sensor, some), 1) * A_PART
    work = f"{ALONE:,} objects after a move, Pandar64, no vehicle, processor time"
    return Timing(work, ours, peak, "the definition", yardstick_s=theirs)


def objects_on_car() -> Timing:
    """The same on a vehicle, against a score of samples after the same move."""
    study = plain_study(car())
    return _against_samples(study, _objects(ALONE), False, f"{ALONE:,} objects, Pandar64")


def objects_in_traffic() -> Timing:
    """Scenes of objects that hide each other."""
    study = plain_study(car())
    what = f"{SCENES} scenes of {IN_A_SCENE} objects, Pandar64"
    return _against_samples(study, _scenes(), True, what)


def objects_of_a_rig() -> Timing:
    """The same of two LiDARs and two cameras, of which one LiDAR moved."""
    what = f"{SCENES} scenes of {IN_A_SCENE}, one Pandar64 of four sensors moved"
    return _against_samples(four_on_car(), _scenes(), True, what)


def objects_of_a_camera() -> Timing:
    """A camera of two million pixels."""
    camera = pe.Camera("two million", 1920, 1080, np.radians(60.0))
    rig = pe.Rig([pe.Sensor("ahead", camera, pe.Pose((1.0, 0.0, 1.5)))])
    what = f"{ALONE:,} objects, camera of 2 MP"
    return _against_samples(pe.Study(rig, car()), _objects(ALONE), False, what)


def _against_samples(study: pe.Study, objects: pe.Objects, traffic: bool, what: str) -> Timing:
    ours = _after_moves(study.rig, objects, study.vehicle, traffic)
    peak = peak_mb()
    evaluator = study.evaluator(SAMPLES)
    rigs = iter([moved_a_little(study.rig, along) for along in np.linspace(0.01, 0.05, MOVES)])
    evaluator.entropy(study.rig)
    theirs = best_of_processor(lambda: evaluator.entropy(next(rigs)), MOVES)
    work = f"{what}, vehicle, after a move, processor time"
    return Timing(work, ours, peak, f"score of {SAMPLES:,} samples", yardstick_s=theirs)


def _after_moves(
    rig: pe.Rig, objects: pe.Objects, vehicle: pe.Vehicle | None, traffic: bool
) -> float:
    known = ObjectMeasurementCache(objects, vehicle, traffic)
    known.measure(rig)
    rigs = iter([moved_a_little(rig, along) for along in np.linspace(0.01, 0.05, MOVES)])
    return best_of_processor(lambda: known.measure(next(rigs)), MOVES)


def _objects(count: int, seed: int = 0) -> pe.Objects:
    """Draw objects round the car as the road's prior has them, beside it and within 100 m."""
    rng = np.random.default_rng(seed)
    labels = rng.integers(0, len(ROAD_CLASSES), 2 * count)
    classes = [ROAD_CLASSES[label] for label in labels]
    x = rng.laplace(0.0, [c.decay_x for c in classes])
    peaked = rng.random(len(labels)) < [c.laplace_share for c in classes]
    laplace = rng.laplace(0.0, [c.laplace_y for c in classes])
    y = np.where(peaked, laplace, rng.normal(0.0, [c.gauss_y for c in classes]))
    sizes = np.array([c.size for c in classes])
    beside = (np.abs(x) > 2.4 + sizes[:, 0] / 2.0) | (np.abs(y) > 1.0 + sizes[:, 0] / 2.0)
    kept = np.flatnonzero(beside & (np.abs(x) < 100.0) & (np.abs(y) < 50.0))[:count]
    centers = np.stack([x, y, sizes[:, 2] / 2.0], axis=1)[kept]
    yaws = rng.normal(0.0, 0.2, count)
    names = tuple(c.name for c in ROAD_CLASSES)
    return pe.Objects(centers, sizes[kept], yaws, labels[kept], class_names=names)


def _scenes() -> pe.Objects:
    """Put objects into scenes in which none overlaps another."""
    pool = _objects(3 * SCENES * IN_A_SCENE, seed=1)
    reach = np.hypot(pool.sizes[:, 0], pool.sizes[:, 1]) / 2.0
    chosen: list[list[int]] = [[]]
    for item in range(len(pool)):
        if len(chosen[-1]) == IN_A_SCENE:
            chosen.append([])
        others = chosen[-1]
        apart = np.hypot(*(pool.centers[others] - pool.centers[item])[:, :2].T)
        if (apart > reach[others] + reach[item]).all():
            others.append(item)
    which = np.array(chosen[:SCENES]).reshape(-1)
    some = pool.some(which)
    scenes = np.repeat(np.arange(SCENES), IN_A_SCENE)
    return pe.Objects(
        some.centers,
        some.sizes,
        some.yaws,
        some.labels,
        class_names=some.class_names,
        scenes=scenes,
    )
