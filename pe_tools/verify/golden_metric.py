"""Golden cases of equations 4 to 9, fusion, frames of reference, the prior, and whole scores.

Constants by hand. A LiDAR's AP is 0.152 ln m + 0.659: one beam has 0.659, sigma 0.517450683 and
1 / sigma^2 3.734754603; two beams have 0.764358371 and 10.5217995. A camera's AP is
0.055 ln m + 0.155: 100 pixels have 0.408284360 and 0.4761013265. The entropy is
H = 1 + ln(2 pi) - ln(1 / sigma^2), and 1 + ln(2 pi) = 2.837877066.
"""

import math
from collections.abc import Sequence

import numpy as np

import pe_core as pe
from pe_core import metric

from . import golden_scenes as scenes
from .golden_case import BY_HAND, ORACLE, CaseValues, GoldenCase
from .oracle import Floats

H_UNSEEN = 16.651386624
H_BEST = -10.975632491
ONE_BEAM = 3.734754603
TWO_BEAMS = 10.5217995
HUNDRED_PIXELS = 0.4761013265
GAUSSIAN = 2.837877066
SLACK = 1e-8
"""The constants have ten digits."""
ROUNDED = 1e-6
"""Sums are rounded to 1e-9, pixel areas are computed by other formulas than those of the oracle."""
SAMPLED = 1 << 14


def metric_cases() -> Sequence[GoldenCase]:
    """Return the cases of the equations."""
    area = "equations"
    camera = metric.RTM3D
    return (
        _hand(
            area,
            "AP without a measurement",
            "eq. 4: clipped to 0.001",
            [0.001],
            found=lambda: _ap(0),
        ),
        _hand(area, "AP of one beam", "eq. 4: ln 1 = 0", [0.659], found=lambda: _ap(1)),
        _hand(
            area, "AP of many beams", "eq. 4: clipped to 0.999", [0.999], found=lambda: _ap(10_000)
        ),
        _hand(
            area,
            "AP of 100 pixels",
            "eq. 4: 0.055 ln 100 + 0.155",
            [0.40828436],
            found=lambda: _floats(metric.average_precision([100.0], camera)),
        ),
        _hand(
            area,
            "sigma",
            "eq. 5: 1 / 0.5 - 1",
            [1.0],
            found=lambda: _floats(metric.sigma_of([0.5])),
        ),
        _hand(
            area,
            "entropy of sigma 1",
            "eq. 8: 1 + ln(2 pi)",
            [GAUSSIAN],
            found=lambda: _floats(metric.entropy_of([1.0])),
        ),
        _hand(
            area,
            "entropy of a voxel that nobody sees",
            "eq. 8: 2 ln 999 + 1 + ln(2 pi)",
            [H_UNSEEN],
            found=lambda: _floats(
                metric.entropy_of(metric.precision_of([0.0], metric.POINTPILLARS))
            ),
        ),
        _hand(
            area,
            "entropy of a saturated voxel",
            "eq. 8: 2 ln(1 / 999) + 1 + ln(2 pi)",
            [H_BEST],
            found=lambda: _floats(
                metric.entropy_of(metric.precision_of([1e9], metric.POINTPILLARS))
            ),
        ),
        _hand(
            area,
            "early fusion",
            "eq. 6: beams of a group add up, 1 + 1 = 2",
            [2.0, 5.0],
            found=lambda: _floats(metric.early_fusion([[1, 2], [1, 3]])),
        ),
        _hand(
            area,
            "late fusion of a LiDAR and a camera",
            "eq. 7: 1 / sigma^2 adds up above that of a blind sensor",
            [GAUSSIAN - math.log(ONE_BEAM + HUNDRED_PIXELS - 1.0 / 998_001.0)],
            found=lambda: _floats(metric.entropy_of(_late([1], [100.0]))),
        ),
        _hand(
            area,
            "a blind camera changes nothing",
            "eq. 7 with the floor of blind sensors",
            [GAUSSIAN - math.log(TWO_BEAMS)],
            found=lambda: _floats(metric.entropy_of(_late([2], [0.0]))),
        ),
        _hand(
            area,
            "perception entropy of two voxels",
            "eq. 9: (1 x 2 + 3 x 6) / 4",
            [5.0],
            found=lambda: [metric.perception_entropy([2.0, 6.0], [1.0, 3.0])],
        ),
    )


def frame_cases() -> Sequence[GoldenCase]:
    """Return the cases of frames of reference."""
    area = "frames"
    half = math.sqrt(0.5)
    return (
        _hand(
            area,
            "positive pitch is nose down",
            "a turn by 30 deg about y takes x to (cos, 0, -sin)",
            [math.sqrt(0.75), 0.0, -0.5],
            found=lambda: _forward((0.0, 30.0, 0.0)),
        ),
        _hand(
            area,
            "positive yaw turns left",
            "a quarter turn takes x to y",
            [0.0, 1.0, 0.0],
            found=lambda: _forward((0.0, 0.0, 90.0)),
        ),
        _hand(
            area,
            "roll, pitch and yaw in this order",
            "Rz(90) Ry(45) Rx(90): the sensor's left, y, becomes z, then (0.7, 0, 0.7), then left",
            [0.0, half, half],
            found=lambda: _floats(
                pe.Pose.from_degrees((0, 0, 0), (90, 45, 90)).ground_from_sensor[:, 1]
            ),
        ),
    )


def prior_cases() -> Sequence[GoldenCase]:
    """Return the cases of the prior."""
    area = "prior"
    return (
        _hand(
            area,
            "labelled boxes",
            "a car of one voxel and a truck of two: half of the mass each, by class",
            [0.5, 0.5, 1.0],
            found=lambda: _masses(()),
        ),
        _hand(
            area,
            "focus",
            "trucks count three times: 1/4 and 3/4",
            [0.25, 0.75, 1.0],
            found=lambda: _masses((pe.Focus(3.0, classes=("truck",)),)),
        ),
        _hand(
            area,
            "the vehicle's own volume carries no weight",
            "a LiDAR whose beams end inside the box: all the mass is outside, and unseen",
            [H_UNSEEN, 0.0, 0.0],
            found=_score_beside_the_body,
            tolerance=SLACK,
        ),
    )


def score_cases() -> Sequence[GoldenCase]:
    """Return the cases of whole scores against equations 4 to 9 by plain floats."""
    area = "score"
    whole = "all voxels of 1 m round a box, two LiDARs and a camera"
    return (
        GoldenCase(
            "entropy and coverage on all voxels",
            area,
            ORACLE,
            whole,
            right=lambda: scenes.plain_score(list(scenes.rig())),
            found=lambda: _entropy_and_coverage(scenes.rig()),
            tolerance=ROUNDED,
        ),
        GoldenCase(
            "a blind sensor by the letter",
            area,
            ORACLE,
            f"{whole}: each group counts",
            right=lambda: scenes.plain_score(list(scenes.rig()), literal=True),
            found=lambda: _entropy_and_coverage(scenes.rig(), pe.PerceptionModel(blind="literal")),
            tolerance=ROUNDED,
        ),
        GoldenCase(
            "a tilted LiDAR on all voxels",
            area,
            ORACLE,
            "a LiDAR rolled by 8, pitched by 14 and turned by 33 deg",
            right=lambda: scenes.plain_score([_tilted()]),
            found=lambda: _entropy_and_coverage(pe.Rig([_tilted()])),
            tolerance=ROUNDED,
        ),
        GoldenCase(
            "what a sensor adds",
            area,
            ORACLE,
            "the rig's entropy without its second LiDAR, less that with it",
            right=_plain_loss,
            found=_loss,
            tolerance=2.0 * ROUNDED,
        ),
        GoldenCase(
            "entropy of a sample of voxels",
            area,
            ORACLE,
            "16,384 sampled voxels agree with all voxels within four standard errors",
            right=lambda: [1.0],
            found=_sample_agrees,
        ),
    )


def _hand(
    area: str, name: str, about: str, right: CaseValues, found: object, tolerance: float = SLACK
) -> GoldenCase:
    return GoldenCase(name, area, BY_HAND, about, right=right, found=found, tolerance=tolerance)  # type: ignore[arg-type]


def _floats(values: object) -> list[float]:
    return [float(value) for value in np.ravel(np.asarray(values, dtype=float))]


def _ap(beams: int) -> list[float]:
    return _floats(metric.average_precision([beams], metric.POINTPILLARS))


def _late(beams: Sequence[int], pixels: Sequence[float]) -> Floats:
    lidar = metric.precision_of(beams, metric.POINTPILLARS)
    return metric.late_fusion([lidar, metric.precision_of(pixels, metric.RTM3D)])


def _forward(rotation: tuple[float, float, float]) -> list[float]:
    return _floats(pe.Pose.from_degrees((0, 0, 0), rotation).ground_from_sensor[:, 0])


def _masses(focus: Sequence[pe.Focus]) -> list[float]:
    """Return the mass of cars and trucks, and of all."""
    boxes = [("car", 0.5, 0.5, 0.5, 1.0, 1.0, 1.0, 0.0)]
    boxes += [("truck", 2.5, 0.5, 1.0, 1.0, 1.0, 2.0, 0.0)]
    space = pe.PerceptionSpace((0.0, 4.0), (0.0, 2.0), (0.0, 2.0), 1.0)
    prior = pe.Prior.from_boxes(boxes, focus)
    blind = scenes.mounted(scenes.lidar(max_range=0.1), (100.0, 100.0, 0.0))
    score = pe.Evaluator(space, prior).score(pe.Rig([blind]))
    parts = [score.per_class[name].share for name in ("car", "truck")]
    return [*parts, sum(parts)]


def _score_beside_the_body() -> list[float]:
    """Return entropy, coverage and standard error of a rig whose beams stay inside the box."""
    inside = scenes.mounted(scenes.lidar(max_range=0.2), (0.26, 0.26, 0.76))
    score = pe.Evaluator(scenes.SPACE, pe.Prior.uniform(), scenes.body()).score(pe.Rig([inside]))
    return [score.entropy, score.coverage, score.stderr]


def _tilted() -> pe.Sensor:
    return scenes.lidar_on_roof((8.0, 14.0, 33.0))


def _score(rig: pe.Rig, model: pe.PerceptionModel | None = None, samples: int = 0) -> pe.Score:
    evaluator = pe.Evaluator(
        scenes.SPACE, pe.Prior.uniform(), scenes.body(), samples=samples, model=model
    )
    return evaluator.score(rig)


def _entropy_and_coverage(rig: pe.Rig, model: pe.PerceptionModel | None = None) -> list[float]:
    score = _score(rig, model)
    return [score.entropy, score.coverage]


def _plain_loss() -> list[float]:
    whole, _ = scenes.plain_score(list(scenes.rig()))
    less, _ = scenes.plain_score([scenes.lidar_on_roof(), scenes.camera_ahead()])
    return [less - whole]


def _loss() -> list[float]:
    lost = _score(scenes.rig()).per_sensor[scenes.second_lidar().name].lost
    return [math.nan if lost is None else lost]


def _sample_agrees() -> list[float]:
    whole = _score(scenes.rig())
    sample = _score(scenes.rig(), samples=SAMPLED)
    return [float(abs(sample.entropy - whole.entropy) <= 4.0 * sample.stderr)]
