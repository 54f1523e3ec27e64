"""The memory that a score takes is known before it begins, and told where there is too little."""

import tracemalloc

import pytest

import pe_core as pe
from pe_core.metric.fusion import Fusion
from pe_core.scoring import grid_scorer
from tests.engine import shapes

SPACE = pe.PerceptionSpace((-24.0, 24.0), (-12.0, 12.0), (0.0, 4.0), 0.2)


def study(lidars, cameras):
    """Sensors over a car, in a grid of 576,000 voxels."""
    lidar = shapes.small_lidar(16, 360)
    camera = pe.Camera("eye", 640, 480, 1.2)
    places = [(0.5 * k - 1.0, 0.0, 1.7) for k in range(max(lidars, cameras))]
    rig = [pe.Sensor(f"l{k}", lidar, pe.Pose(p)) for k, p in enumerate(places[:lidars])]
    rig += [pe.Sensor(f"c{k}", camera, pe.Pose(p)) for k, p in enumerate(places[:cameras])]
    return pe.Study(pe.Rig(rig), shapes.box_car(), SPACE)


def needed_by(ours):
    """Memory [bytes] that a score on the grid is estimated to take, by two threads."""
    densities = ours.prior.densities(SPACE)
    fusion = Fusion(pe.PerceptionModel())
    scorer = grid_scorer.GridScorer(SPACE, densities, ours.vehicle, fusion, workers=2)
    return scorer.needs([[sensor] for sensor in ours.rig], SPACE)


@pytest.mark.parametrize(("lidars", "cameras"), [(1, 0), (2, 2), (5, 1), (0, 3)])
def test_estimates_are_near_what_is_taken(lidars, cameras):
    """Within the factor that is documented, for all that a score tells."""
    ours = study(lidars, cameras)
    tracemalloc.start()
    try:
        evaluator = ours.evaluator(0, workers=2)
        evaluator.score(ours.rig)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    estimate = needed_by(ours)
    assert peak / grid_scorer.FACTOR <= estimate <= peak * grid_scorer.FACTOR


@pytest.mark.parametrize(("lidars", "cameras"), [(1, 0), (6, 6)])
def test_an_estimate_of_samples_is_not_below_what_is_taken(lidars, cameras):
    """Nor more than the factor above it: drawn, and all that a score tells of one or twelve."""
    ours = study(lidars, cameras)
    samples = 65_536
    tracemalloc.start()
    try:
        ours.evaluator(samples).score(ours.rig)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    columns = grid_scorer.columns_bytes(SPACE, len(ours.prior.class_names))
    assert peak <= grid_scorer.samples_bytes(samples, columns) <= peak * grid_scorer.FACTOR


def test_too_little_memory_is_one_line_with_what_would_fit(monkeypatch):
    ours = study(4, 1)
    evaluator = ours.evaluator(0, workers=2)
    enough = needed_by(ours)
    monkeypatch.setattr(grid_scorer, "available_bytes", lambda: enough - 1)
    words = (
        r"score: memory: .* in the [\d.]+ MB .*try samples = 262144 or interval = 0\.4, found about"
    )
    with pytest.raises(pe.InputError, match=words):
        evaluator.score(ours.rig)
    monkeypatch.setattr(grid_scorer, "available_bytes", lambda: enough)
    assert evaluator.score(ours.rig).entropy == evaluator.entropy(ours.rig)
    monkeypatch.setattr(grid_scorer, "available_bytes", lambda: 1000)
    with pytest.raises(pe.InputError, match="memory"):
        evaluator.entropy(ours.rig)
    with pytest.raises(pe.InputError, match="memory"):  # before the prior is laid out
        ours.evaluator(0)
