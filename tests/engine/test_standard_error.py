"""The standard error of a sampled score: neither half nor twice what it has to be."""

import math
from statistics import fmean, stdev

import numpy as np
import pytest

import pe_core as pe
from pe_core.metric import POINTPILLARS, entropy_of, precision_of
from pe_core.scoring import draw
from pe_tools.cli.terminal import summary, with_error
from tests.engine import shapes

SPACE = shapes.small_space()
RIGS = {
    "lidar": pe.Rig([shapes.lidar_on_roof(shapes.small_lidar(16, 180))]),
    "camera": pe.Rig([shapes.camera(60.0)]),
}


@pytest.mark.parametrize("rig", RIGS)
def test_it_is_the_scatter_of_scores_on_other_samples(rig):
    """120 samples of 4096 voxels: it errs high, by less than 2, and never low.

    Each of its 16 runs fills space evenly by itself and the whole more so, which is why it errs
    high: 1.4 for the LiDAR, 1.7 for the camera. Half of it would be too low, twice too high.
    """
    scores = []
    for shift in np.random.default_rng(11).random((120, 3)):
        evaluator = pe.Evaluator(SPACE, pe.Prior.road(), samples=4096, shift=tuple(shift))
        scores.append(evaluator.score(RIGS[rig]))
    told = math.sqrt(fmean(s.stderr**2 for s in scores))
    assert 1.0 < told / stdev(s.entropy for s in scores) < 2.0


def test_it_is_that_of_the_mean_of_sixteen_runs():
    """By its definition: the scatter of the runs' means, n - 1, over the root of their number."""
    vehicle, sensor = shapes.box_car(), RIGS["lidar"]["roof"]
    evaluator = pe.Evaluator(SPACE, pe.Prior.road(), vehicle, samples=3000)
    sample = draw(pe.Prior.road().densities(SPACE), SPACE, 3000, vehicle.top(SPACE))
    m = pe.measure(sensor, sample.centers, SPACE.interval, vehicle)
    entropies = entropy_of(precision_of(m, POINTPILLARS)).tolist()
    means = [
        fmean(h for h, own in zip(entropies, sample.run.tolist(), strict=True) if own == run)
        for run in range(16)
    ]
    score = evaluator.score(RIGS["lidar"])
    assert score.entropy == pytest.approx(fmean(entropies), abs=1e-8)
    assert score.stderr == pytest.approx(stdev(means) / 4.0, abs=1e-8)


BLIND = shapes.lidar_on_roof(shapes.small_lidar(2, 4), (0.0, 0.0, 900.0))
EVERYWHERE = pe.Lidar("all", np.radians(np.linspace(-89.0, 89.0, 90)), 180, 100.0)
TINY = pe.PerceptionSpace((-0.8, 0.8), (-0.8, 0.8), (0, 1.6), 0.2)


@pytest.mark.parametrize(
    "rig, space, entropy",
    [
        (pe.Rig([BLIND]), SPACE, 16.651386624),
        (pe.Rig([shapes.lidar_on_roof(EVERYWHERE, (0.05, 0.05, 0.85))]), TINY, -10.975632491),
    ],
    ids=["nothing seen", "all seen"],
)
def test_where_every_voxel_is_alike_it_is_half_of_what_the_rule_of_three_leaves(
    rig, space, entropy
):
    """Up to 3 voxels in 2048 might be anything from 16.651 to -10.976, 95 times in 100."""
    score = pe.Evaluator(space, pe.Prior.uniform(), samples=2048).score(rig)
    assert score.entropy == entropy
    assert score.stderr == pytest.approx(1.5 / 2048 * (16.651386624 + 10.975632491), abs=1e-9)


def test_it_covers_what_a_sample_that_sees_nothing_has_missed():
    """A camera that sees 9 of 32,000 voxels, of which no sample of 1024 need have any."""
    camera = shapes.camera(3.0, (19.2, 0.1, 4.9), (0.0, -1.0, 0.0))
    truth = pe.Evaluator(SPACE, pe.Prior.uniform()).score(pe.Rig([camera]))
    assert 0.0 < truth.coverage < 1e-3
    for shift in np.random.default_rng(3).random((20, 3)):
        sample = pe.Evaluator(SPACE, pe.Prior.uniform(), samples=1024, shift=tuple(shift))
        score = sample.score(pe.Rig([camera]))
        assert abs(score.entropy - truth.entropy) <= 2.0 * score.stderr


def test_it_falls_with_the_number_of_voxels():
    """Sixteen times as many: a quarter by chance alone, less for points that fill space evenly."""
    few, many = (
        pe.Evaluator(SPACE, pe.Prior.road(), samples=n).score(RIGS["lidar"]).stderr
        for n in (2048, 32_768)
    )
    assert many < few / 3.0


def test_no_sample_is_printed_as_exact():
    """Not where nothing is seen, and not where the error is less than the last digit."""
    study = pe.Study(pe.Rig([BLIND]), space=SPACE, samples=2048)
    job = pe.ScoreJob(study)
    for _ in job:
        pass
    assert summary(job.outcome).startswith("entropy   16.6514 +- 0.0202 nats\n")
    assert with_error(16.6514, 2e-6) == "16.6514 +- 0.0001 nats"
    assert with_error(16.6514, 0.0) == "16.6514 nats"
