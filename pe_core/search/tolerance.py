"""What a placement has to stand: sensors mounted a little off, and the loss of one.

Errors are drawn once, from the study's seed: every candidate is judged with the same ones, so that
candidates stay comparable (common random numbers). A coordinate's errors are the middles of equal
shares of the normal distribution, scaled to its sigma and shuffled (a Latin hypercube); the second
half of the draws are the first with their signs reversed (antithetic). So each coordinate's errors
have a mean of 0 and the sigma asked for, and of their effect what is linear cancels out.

Measuring sensors is dear, fusing them is cheap. So the draws of one sensor meet several draws of
the others: in combination k each sensor is k draws further along than the one before it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError, shown
from ..scene.geometry import FARTHEST_M, Pose, rotate, rotation_matrix, rpy_from_matrix
from ..scene.sensors import Rig
from ..text.values import Angle, Number, Whole
from .axes import AXES, pose_from_values

Floats = NDArray[np.float64]

DRAWS = 8
"""Draws unless a study says otherwise."""
RULES: dict[str, Number | Whole] = {
    "position": Number(0.0, 1.0, unit="m", noun="length"),
    "angle": Angle(0.0, 45.0),
    "draws": Whole(2, 1024),
}
COMBINATIONS = 4
"""In how many ways the sensors' draws are put together; in one where sensors fail, too."""
SEARCHED, FRESH = 0, 1
"""Errors that a search judges with; and others, for what it found."""


@dataclass(frozen=True, slots=True)
class Tolerance:
    """What a candidate is judged with; by default nothing: it stands where it is meant to.

    Parameters
    ----------
    position, angle : float
        Mounting errors of each sensor, 1 sigma of each coordinate: along x, y and z of the ground
        frame [m]; of roll, pitch and yaw in the sensor's own frame [rad].
    draws : int
        How many times all sensors are mounted anew; an even number.
    failures : bool
        Score the mean over the loss of each one sensor.
    worst : bool
        Score the worst of all these cases instead of their mean.

    Raises
    ------
    InputError
        When a number is out of its range, or the worst is asked of no cases.
    """

    position: float = 0.0
    angle: float = 0.0
    draws: int = DRAWS
    failures: bool = False
    worst: bool = False

    def __post_init__(self) -> None:
        for name, rule in RULES.items():
            value = rule.checked("optimize", f"tolerance.{name}", getattr(self, name))
            object.__setattr__(self, name, value)
        if self.draws % 2:
            raise InputError("optimize", "tolerance.draws", "an even number", self.draws)
        for name in ("failures", "worst"):
            if not isinstance(getattr(self, name), bool):
                raise InputError("optimize", name, "true or false", shown(getattr(self, name)))
        if self.worst and not self.is_on:
            raise InputError("optimize", "worst", "a tolerance, or failures = true", "neither")

    @property
    def mounts_off(self) -> bool:
        """Whether there are mounting errors."""
        return self.position > 0.0 or self.angle > 0.0

    @property
    def is_on(self) -> bool:
        """Whether a candidate is judged in any other case than as it is."""
        return self.mounts_off or self.failures

    def checked(self, rig: Rig) -> Tolerance:
        """Return itself; `InputError` when the rig has no sensor to lose."""
        if self.failures and len(rig) < 2:
            raise InputError("optimize", "failures", "a rig of at least two sensors", "one")
        return self

    def cases(self, rig: Rig, seed: int = 0) -> list[Rig]:
        """Return the rigs that a candidate is judged by: mounted off, and without each sensor."""
        mounted = mounted_off(rig, self, seed) if self.mounts_off else [rig]
        if not self.failures:
            return mounted
        once = mounted[: self.draws]
        return [without for each in once for without in without_each(each)]


def mounted_off(rig: Rig, tolerance: Tolerance, seed: int = 0, stream: int = SEARCHED) -> list[Rig]:
    """Return a rig with the mounting errors of each draw, put together in each way.

    Poses are rounded as placements are.

    Parameters
    ----------
    rig : Rig
    tolerance : Tolerance
    seed, stream : int
        Others give other errors. Those of a sensor depend on its place in the rig, and on no other
        sensor: sensors that are tied to each other are mounted off each by itself.
    """
    poses = [
        [off(sensor.pose, error) for error in _drawn(tolerance, (seed, stream, place))]
        for place, sensor in enumerate(rig)
    ]
    ways = min(COMBINATIONS, tolerance.draws) if len(rig) > 1 else 1
    return [
        rig.with_poses([own[(draw + way * n) % tolerance.draws] for n, own in enumerate(poses)])
        for way in range(ways)
        for draw in range(tolerance.draws)
    ]


def without_each(rig: Rig) -> list[Rig]:
    """Return the rig without each one of its sensors, of which there are at least two."""
    return [Rig([s for s in rig if s is not lost]) for lost in rig]


def _drawn(tolerance: Tolerance, seed: tuple[int, ...]) -> Floats:
    """Errors of one sensor: (draws, 6), in metres and radians."""
    rng, half = np.random.default_rng(seed), tolerance.draws // 2
    shuffled = np.stack([_middles(half)[np.argsort(rng.random(half))] for _ in AXES], axis=1)
    signs = np.where(rng.random(shuffled.shape) < 0.5, -1.0, 1.0)
    first = shuffled * signs * ([tolerance.position] * 3 + [tolerance.angle] * 3)
    return np.concatenate([first, -first])


def _middles(half: int) -> Floats:
    """Middles of equal shares of the upper half of the normal distribution, of a sigma of 1."""
    normal = NormalDist()
    middles = np.array([normal.inv_cdf(0.5 + (n + 0.5) / (2 * half)) for n in range(half)])
    return middles / math.sqrt(float(np.mean(middles * middles)))


def off(pose: Pose, error: Floats) -> Pose:
    """Return a pose with an error: moved along the ground's axes, turned in its own frame."""
    moved = np.clip(np.array(pose.position) + error[:3], -FARTHEST_M, FARTHEST_M)
    turn = rotation_matrix(*error[3:].tolist())
    rpy = rpy_from_matrix(rotate(pose.ground_from_sensor, turn.T).T)
    return pose_from_values(dict(zip(AXES, (*moved.tolist(), *rpy), strict=True)))
