"""What would help: for each requirement that is not met, the nearest placement found that meets it.

One design variable of the search is changed at a time, by small steps first; then one sensor (or
linked pair) is put elsewhere within its range, the nearest places first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import chain

import numpy as np

from ..scene.rig import Rig
from ..scoring.requirements import RequirementChecker
from ..search import Parametrization
from ..search.design_variable import METRE, RADIAN, SHARE
from ..search.methods.method import sampled_candidate
from ..search.parametrization import Candidate
from .study import Study

HELP_STEPS = {
    METRE: (0.05, 0.1, 0.2, 0.4, 0.8),
    RADIAN: (0.05, 0.1, 0.2, 0.4, 0.8),
    SHARE: (0.1, 0.2),
}
"""Steps of one design variable that are tried: in metres, radians (3 to 46 deg), and shares."""
HELP_PLACES = 40
"""Places within its range that are tried for each sensor, after those steps."""
POSITION_DECIMALS, ANGLE_DECIMALS = 5, 4
"""Poses are rounded to these [m, deg]: what a suggestion says is what was checked."""


@dataclass(frozen=True, slots=True)
class Suggestion:
    """The nearest placement found that meets a requirement, and what it breaks.

    Attributes
    ----------
    rig : Rig
    moved : tuple of str
        Names of the sensors that are elsewhere.
    breaks : tuple of str
        Requirements that were met and no longer are.
    """

    rig: Rig
    moved: tuple[str, ...]
    breaks: tuple[str, ...]

    @property
    def text(self) -> str:
        """Where the sensors would be: "rear at (-2.5, 0, 1.5) m, roll 0, pitch 30, yaw 180".

        Figures are those of a study file: typed in, they give the placement that was checked.
        """
        where = []
        for name in self.moved:
            pose = self.rig[name].pose
            x, y, z = (_figure(v, POSITION_DECIMALS) for v in pose.position)
            roll, pitch, yaw = (_figure(v, ANGLE_DECIMALS) for v in pose.rotation_deg)
            where.append(f"{name} at ({x}, {y}, {z}) m, roll {roll}, pitch {pitch}, yaw {yaw}")
        broken = f"; that breaks {', '.join(self.breaks)}" if self.breaks else ""
        return "; ".join(where) + broken


def suggestions(
    study: Study, checker: RequirementChecker | None = None
) -> dict[str, Suggestion | None]:
    """Return for each requirement that is not met the nearest placement found that meets it.

    Mounting errors are left out.

    Returns
    -------
    dict of Suggestion or None
        By name; None where no placement that was tried is enough.
    """
    checker, coding = checker or study.checker(), study.coding()
    names = [each.name for each in checker.requirements]
    before = checker.shortfalls(study.rig)
    left = [number for number, off in enumerate(before) if off]
    found: dict[str, Suggestion | None] = dict.fromkeys(names[k] for k in left)
    for rig in chain(_steps_of_one(coding), _places_of_one(coding, study.search.seed)):
        if not left:
            break
        after = checker.shortfalls(rig)
        for number in [k for k in left if not after[k]]:
            left.remove(number)
            moved = tuple(s.name for s in rig if s.pose != study.rig[s.name].pose)
            broken = [
                n for n, was, off in zip(names, before, after, strict=True) if off and not was
            ]
            found[names[number]] = Suggestion(rig, moved, tuple(broken))
    return found


def _steps_of_one(coding: Parametrization) -> Iterator[Rig]:
    """Yield allowed placements that differ from the start in one variable, near ones first."""
    start = coding.start.vector
    for rank in range(max(map(len, HELP_STEPS.values()))):
        for number, variable in enumerate(coding.variables):
            for step in HELP_STEPS[variable.unit][rank : rank + 1]:
                for shift in (step, -step):
                    vector = list(start)
                    vector[number] = variable.clipped(start[number] + shift)
                    candidate = coding.candidate(vector)
                    if candidate.vector != start and coding.allowed(candidate.rig):
                        yield candidate.rig


def _places_of_one(coding: Parametrization, seed: int) -> Iterator[Rig]:
    """Yield placements with one sensor, or linked pair, anywhere in its range, near ones first."""
    variables, start = coding.variables, coding.start.vector
    rng, sampled = np.random.default_rng(seed), list[tuple[float, Candidate]]()

    def sample(block: range) -> list[float]:
        vector = list(start)
        for k in block:
            vector[k] = float(rng.uniform(variables[k].low, variables[k].high))
        return vector

    for block in coding.blocks:
        for _ in range(HELP_PLACES):
            candidate = sampled_candidate(coding, partial(sample, block))
            if candidate is not None:
                shares = [
                    (candidate.vector[k] - start[k]) / max(v.high - v.low, 1e-9)
                    for k, v in enumerate(variables)
                ]
                sampled.append((math.hypot(*shares), candidate))
    for _, candidate in sorted(sampled, key=lambda pair: pair[0]):
        yield candidate.rig


def _figure(value: float, decimals: int) -> str:
    """Return a figure as it is in a study file, without zeros at its end."""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
