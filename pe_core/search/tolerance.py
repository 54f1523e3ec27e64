"""Tolerance: mounting errors of the sensors, the failure of one, and how a rig bears them.

Errors are sampled once, from the study's seed: every candidate is evaluated with the same errors,
so that candidates stay comparable (common random numbers). A coordinate's errors are the middles of
equal shares of the normal distribution, scaled to its sigma and shuffled (a Latin hypercube); the
second half of the draws are the first with their signs reversed (antithetic). So each coordinate's
errors have a mean of 0 and the given sigma, and the linear part of their effect cancels out.

Measuring sensors is expensive, fusing them is cheap. So the draws of one sensor are combined with
several draws of the others: in combination k, the draw of each sensor is k draws after that of the
sensor before it.

`RobustFigure` is what a search minimises under a `Tolerance`; `robustness` reports how far the
entropy of the start and of the result moves.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from statistics import NormalDist
from typing import Annotated, Any

import numpy as np

from ..base.arrays import Floats
from ..base.errors import InputError
from ..base.setting import FLAG, NotStored, Panel, check_settings, setting
from ..base.values import Angle, Number, degrees_in_file, error_text, rounded
from ..geometry.poses import FARTHEST_M, Pose, rotate, rotation_matrix, rpy_from_matrix
from ..scene.rig import Rig
from ..scoring.rig_batch import mean_or_worst
from ..scoring.score import NO_DIFFERENCE, RigEvaluator, is_noise, standard_error
from .domains import AXES, pose_from_values
from .objective import Objective
from .race import entropy_objective

DRAWS = 8
"""Errors of each sensor that a candidate is evaluated with; a search takes as many times as long.
The least whose antithetic halves still have four levels a coordinate."""
COMBINATIONS = 4
"""In how many ways the sensors' draws are combined; only one is used when sensors fail, too."""
SEARCHED = 0
FRESH = 1
"""Streams of errors: those that a search evaluates with, and others for its result."""


@dataclass(frozen=True, slots=True)
class Tolerance:
    """Mounting errors and failures that a candidate is evaluated with; by default, none.

    Its settings say what they mean; `draws`, an even number, is no setting. Errors are 1 sigma of
    each coordinate: along x, y and z of the ground frame [m]; of roll, pitch and yaw in the
    sensor's own frame [rad].

    `InputError` when a number is out of its range, or `worst` is set without errors or failures.
    """

    position: float = setting(
        0.0,
        Number(0.0, 1.0, unit="m", noun="length"),
        "How far off sensors are mounted along each axis: 1 sigma",
        Panel("tolerance_position", "Position", default=0.01, precision=3, step=0.1),
    )
    angle: float = setting(
        0.0,
        Angle(0.0, 45.0),
        "How far off sensors are turned about each of their axes: 1 sigma",
        Panel("tolerance_angle", "Angle °", default=0.3, precision=2, step=1.0),
    )
    draws: Annotated[int, NotStored] = DRAWS
    failures: bool = setting(
        False,
        FLAG,
        "Evaluate each candidate by its mean over the loss of each one sensor",
        Panel("failures", "Sensor Failures"),
    )
    worst: bool = setting(
        False,
        FLAG,
        "Evaluate by the worst of mounting errors and failures instead of their mean",
        Panel("worst", "Worst Case"),
    )

    def __post_init__(self) -> None:
        check_settings(self, "optimize", "tolerance.")
        if self.draws < 2 or self.draws % 2:
            raise InputError("tolerance", "draws", "an even number from 2 on", self.draws)
        if self.worst and not self.is_on:
            raise InputError(
                "optimize", "tolerance.worst", "a tolerance, or failures = true", "neither"
            )

    @property
    def mounts_off(self) -> bool:
        """Whether there are mounting errors."""
        return self.position > 0.0 or self.angle > 0.0

    @property
    def is_on(self) -> bool:
        """Whether there are mounting errors or failures."""
        return self.mounts_off or self.failures

    def checked(self, rig: Rig) -> "Tolerance":
        """Return itself; raise `InputError` if the only sensor of a rig would have to fail."""
        if self.failures and len(rig) < 2:
            raise InputError(
                "optimize", "tolerance.failures", "a rig of at least two sensors", "one"
            )
        return self

    def cases(self, rig: Rig, seed: int = 0) -> list[Rig]:
        """Return the rigs that a candidate is evaluated by: with errors, without each sensor."""
        mounted = mounted_off(rig, self, seed) if self.mounts_off else [rig]
        if not self.failures:
            return mounted
        one_combination = mounted[: self.draws]
        return [failed for rig in one_combination for failed in rig.without_each()]


def mounted_off(rig: Rig, tolerance: Tolerance, seed: int = 0, stream: int = SEARCHED) -> list[Rig]:
    """Return a rig with mounting errors: one rig for each draw and combination, poses rounded.
    Other numbers of `seed` and `stream` give other errors. The errors of a sensor depend on its
    position in the rig, and on no other sensor: linked sensors have errors of their own."""
    poses = [
        [with_error(sensor.pose, error) for error in _errors(tolerance, (seed, stream, number))]
        for number, sensor in enumerate(rig)
    ]
    combinations = min(COMBINATIONS, tolerance.draws) if len(rig) > 1 else 1
    return [
        rig.with_poses([drawn[(draw + k * n) % tolerance.draws] for n, drawn in enumerate(poses)])
        for k in range(combinations)
        for draw in range(tolerance.draws)
    ]


def _errors(tolerance: Tolerance, seed: tuple[int, ...]) -> Floats:
    """Sample the errors of one sensor, (draws, 6) [m, rad]."""
    rng = np.random.default_rng(seed)
    half = tolerance.draws // 2
    shuffled = np.stack([_middles(half)[np.argsort(rng.random(half))] for _ in AXES], axis=1)
    signs = np.where(rng.random(shuffled.shape) < 0.5, -1.0, 1.0)
    first = shuffled * signs * ([tolerance.position] * 3 + [tolerance.angle] * 3)
    return np.concatenate([first, -first])


def _middles(half: int) -> Floats:
    """Return the middles of equal shares of the upper half of a normal distribution, sigma 1."""
    normal = NormalDist()
    middles = np.array([normal.inv_cdf(0.5 + (n + 0.5) / (2 * half)) for n in range(half)])
    return middles / math.sqrt(float(np.mean(middles * middles)))


def with_error(pose: Pose, error: Floats) -> Pose:
    """Return a pose with an error (6,): moved along the ground's axes, turned in its own frame."""
    moved = np.clip(np.array(pose.position) + error[:3], -FARTHEST_M, FARTHEST_M)
    turn = rotation_matrix(*error[3:].tolist())
    rpy = rpy_from_matrix(rotate(pose.ground_from_sensor, turn.T).T)
    return pose_from_values(dict(zip(AXES, (*moved.tolist(), *rpy), strict=True)))


class RobustFigure:
    """The entropy of a rig with all mounting errors and failures of a tolerance: mean or worst. The
    mounting errors, drawn from `seed`, are the same for every rig."""

    def __init__(self, evaluator: RigEvaluator, tolerance: Tolerance, seed: int = 0) -> None:
        self._evaluator = evaluator
        self._tolerance = tolerance
        self._seed = seed

    def __call__(self, rig: Rig) -> float:
        """Return the mean of the entropies of a rig's cases, or the highest [nats]."""
        entropies = self._evaluator.entropies(self._tolerance.cases(rig, self._seed))
        return mean_or_worst(entropies, self._tolerance.worst)

    def shared_parts(self) -> tuple[object, ...]:
        """Return what workers are sent once: the evaluator."""
        return (self._evaluator,)


def objective_of(evaluator: RigEvaluator, tolerance: Tolerance, seed: int = 0) -> Objective:
    """Return what a search minimises: the entropy, or `RobustFigure` if a tolerance is on."""
    if tolerance.is_on:
        return Objective(RobustFigure(evaluator, tolerance, seed))
    return entropy_objective(evaluator)


WORKSHOP = Tolerance(0.01, math.radians(0.3), draws=6)
"""The errors of a careful workshop: these are evaluated where a study names none."""


@dataclass(frozen=True, slots=True)
class RigRobustness:
    """The entropies of one placement with errors and failures, all on one sample of voxels [nats].

    `entropy`: Without errors and failures.
    `mounted_off, mounted_worst`: Mean over the mounting errors, and the worst.
    `stderr`: Standard error of the rise of `mounted_off`, from the scatter of the draws and of the
        voxels; an overestimate.
    `failed, failed_worst`: Mean over the failures of each single sensor, and the worst; None for a
        single sensor.
    `missed`: The sensor whose failure is the worst.
    """

    entropy: float
    mounted_off: float
    mounted_worst: float
    stderr: float
    failed: float | None = None
    failed_worst: float | None = None
    missed: str | None = None

    def rise_text(self, plus_minus: str = "+-") -> str:
        """Return the rise with its standard error; within two of these none is shown."""
        sure = f"{plus_minus} {error_text(self.stderr)}"
        if is_noise(self.rise, self.stderr):
            return f"{NO_DIFFERENCE} beyond {sure}"
        return f"{self.rise:+.3f} {sure}"

    @property
    def rise(self) -> float:
        """How much mounting errors raise the entropy on average [nats]."""
        return rounded(self.mounted_off - self.entropy)

    @property
    def loss(self) -> float | None:
        """Mean rise of the entropy when a sensor fails [nats]; None for a single sensor."""
        return None if self.failed is None else rounded(self.failed - self.entropy)


@dataclass(frozen=True, slots=True)
class Robustness:
    """The robustness of the start and of the result of a search.

    `errors`: The mounting errors: the study's, or `WORKSHOP`. The search did not use these draws.
    `samples`: How many voxels were evaluated.
    """

    errors: Tolerance
    samples: int
    before: RigRobustness
    after: RigRobustness

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {
            "position": self.errors.position,
            "angle": degrees_in_file(self.errors.angle),
            "draws": self.errors.draws,
            "samples": self.samples,
            "before": asdict(self.before),
            "after": asdict(self.after),
        }


def robustness(
    evaluator: RigEvaluator, before: Rig, after: Rig, tolerance: Tolerance, seed: int = 0
) -> Robustness:
    """Return how far errors and failures raise the entropy of two placements.

    The evaluator should be sampled: every sensor is measured once for each draw. The mounting
    errors of the tolerance are used; without any, those of `WORKSHOP`. `seed` is that of the study;
    a search with this seed uses other errors.
    """
    errors = replace(tolerance if tolerance.mounts_off else WORKSHOP, failures=False, worst=False)
    first = _robustness_of(evaluator, before, errors, seed)
    last = first if after is before else _robustness_of(evaluator, after, errors, seed)
    return Robustness(errors, evaluator.samples, first, last)


def _robustness_of(
    evaluator: RigEvaluator, rig: Rig, errors: Tolerance, seed: int
) -> RigRobustness:
    off = mounted_off(rig, errors, seed, FRESH)
    rigs_without = rig.without_each() if len(rig) > 1 else []
    cases = [rig, *off, *rigs_without]
    entropy, *entropies = evaluator.entropies(cases)
    with_errors = entropies[: len(off)]
    failed = entropies[len(off) :]
    own, *residuals = evaluator.residuals(cases)  # of the same rigs: no sensor is measured again
    by_draw = residuals[: len(off)]
    of_draws = _error_of_draws(with_errors, errors.draws, len(rig))
    of_voxels = standard_error(np.mean(by_draw, axis=0) - own)
    found = RigRobustness(
        entropy,
        mounted_off=rounded(float(np.mean(with_errors))),
        mounted_worst=max(with_errors),
        stderr=rounded(math.hypot(of_draws, of_voxels)),
    )
    if not failed:
        return found
    return replace(
        found,
        failed=rounded(float(np.mean(failed))),
        failed_worst=max(failed),
        missed=rig.sensors[int(np.argmax(failed))].name,
    )


def _error_of_draws(entropies: Sequence[float], draws: int, sensors: int) -> float:
    """Return the standard error from the scatter of each sensor's pairs of opposite draws."""
    half = draws // 2
    variance = 0.0
    if half < 2:
        return 0.0
    combinations = np.array(entropies).reshape(-1, draws)
    for number in range(sensors):
        aligned = [np.roll(values, k * number) for k, values in enumerate(combinations)]
        by_draw = np.mean(aligned, axis=0)
        variance += float(np.var(by_draw.reshape(2, half).mean(axis=0), ddof=1)) / half
    return rounded(math.sqrt(variance))
