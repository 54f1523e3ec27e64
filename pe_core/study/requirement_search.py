"""Requirements and blind ground as constraints of a search, and what would help to meet them.

`[optimize] requirements = "keep"`: a placement that meets all requirements beats each one that does
not. Of placements that break some, the one with the least violation is the best; their entropies do
not matter and are not computed. `[optimize] keep = ["blind_ground"]`: a placement with more blind
ground than is wanted, or than the study's own where nothing is wanted, is infeasible, too.

For each requirement that is not met, `suggestions` looks for the nearest placement that meets it.
One design variable of the search is changed at a time, by small steps first; then one sensor (or
linked pair) is put elsewhere within its range, the nearest places first.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain

import numpy as np

from ..base.errors import InputError
from ..base.values import rounded
from ..scene.rig import Rig
from ..scoring.requirements import RequirementChecker
from ..scoring.score import Objective
from ..scoring.sight import Sight
from ..search import Parametrization, Tolerance, shared_parts
from ..search.dispatch import value_below
from ..search.domains import METRE, RADIAN, SHARE
from ..search.key_figures import KEPT, KEY_FIGURES, PARTS, Wanted
from ..search.methods.method import sampled_candidate
from ..search.parametrization import Candidate
from .conditions import mounting_cases
from .study import Study

KEEP = "keep"
INFEASIBLE = 100.0
"""Value of a placement that breaks a constraint, without the violation: above all entropies."""
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


class FiguresLimit:
    """The constraint that key figures of a rig cost no more than limits; the vehicle is as drawn.

    `keys` are those of `KEY_FIGURES`. A limit is the cost of what is wanted, and those of the rig
    `start` where nothing is.
    """

    def __init__(self, sight: Sight, keys: Sequence[str], wanted: Wanted, start: Rig) -> None:
        self._sight, self._keys = sight, tuple(keys)
        self._limits = {
            key: own if asked is None else (KEY_FIGURES[key].cost_of(asked),) * len(own)
            for key, own in self._costs(start).items()
            for asked in [getattr(wanted, key)]
        }

    def _costs(self, rig: Rig) -> dict[str, tuple[float, ...]]:
        rows = [KEY_FIGURES[key] for key in self._keys]
        found = {part: PARTS[part](self._sight, rig) for part in {row.part: 0 for row in rows}}
        return {row.key: row.costs(found[row.part]) for row in rows}

    def violation(self, rig: Rig) -> float:
        """Return the sum of the shares of a rig's costs above their limits; 0 if none is."""
        pairs = (
            pair
            for key, costs in self._costs(rig).items()
            for pair in zip(costs, self._limits[key], strict=True)
        )
        return rounded(sum(1.0 - limit / value for value, limit in pairs if value > limit))


class RequirementConstraint:
    """The constraint that all requirements of a study are met, with the tolerance's errors."""

    def __init__(self, checker: RequirementChecker, tolerance: Tolerance, seed: int = 0) -> None:
        self._checker, self._tolerance, self._seed = checker, tolerance, seed

    def violation(self, rig: Rig) -> float:
        """Return the sum of the violations of all requirements; 0 where all are met."""
        wanted = self._checker.requirements
        cases = mounting_cases(wanted, rig, self._tolerance, self._seed)
        return rounded(sum(self._checker.shortfalls(rig, cases)))


FeasibilityRule = FiguresLimit | RequirementConstraint
"""Something that a placement keeps, or breaks by its `violation`."""


class FeasibleFirst:
    """What a search with constraints minimises.

    The value of a placement is its entropy [nats], that of the objective, if it keeps all
    constraints; else it is `INFEASIBLE` and the sum of the violations.
    """

    def __init__(self, objective: Objective, constraints: Sequence[FeasibilityRule]) -> None:
        self._objective, self._constraints = objective, tuple(constraints)

    def entropy(self, rig: Rig) -> float:
        """Return the value of a placement."""
        violation = self.violation(rig)
        return INFEASIBLE + violation if violation else self._objective.entropy(rig)

    def below(self, rig: Rig, cutoff: float) -> float:
        """Return the value of a placement; inf where it is not below `cutoff`.

        What is not below a cutoff with its entropy is not below it if it breaks a constraint, so
        constraints, which take longer, are then not checked.
        """
        if cutoff > INFEASIBLE:
            return self.entropy(rig)
        found = value_below(self._objective, rig, cutoff)
        violation = self.violation(rig) if found < cutoff else 0.0
        return INFEASIBLE + violation if violation else found

    def shared_parts(self) -> tuple[object, ...]:
        """Return what workers are sent once: the parts of the objective, and the constraints."""
        return (*shared_parts(self._objective), *self._constraints)

    def violation(self, rig: Rig) -> float:
        """Return the sum of the violations of all constraints; 0 where all are kept."""
        return rounded(sum(each.violation(rig) for each in self._constraints))


def constraints_of(study: Study) -> tuple[FeasibilityRule, ...]:
    """Return what placements of a study's search have to keep: requirements, key figures.

    `InputError` when a zone of a requirement that is to be kept cannot be placed.
    """
    search, constraints = study.search, list[FeasibilityRule]()
    if search.requirements == KEEP and study.requirements:
        checker = study.checker()
        constraints.append(RequirementConstraint(checker, search.tolerance, search.seed))
    if keep := [key for key in KEPT if key in search.goals.keep]:
        if "reach" in keep and study.targets.are_objects:
            raise InputError("optimize", "keep", "a reach of voxels", "a study on objects")
        limit = FiguresLimit(study.sight(), keep, search.goals.wanted, study.rig)
        constraints.append(limit)
    return tuple(constraints)


def feasible_first(objective: Objective, constraints: Sequence[FeasibilityRule]) -> Objective:
    """Return what a search minimises: the objective, or `FeasibleFirst` of it."""
    return FeasibleFirst(objective, constraints) if constraints else objective


def is_infeasible(value: float) -> bool:
    """Whether a value of a search is that of a placement that breaks a constraint."""
    return value >= INFEASIBLE


@dataclass(frozen=True, slots=True)
class Suggestion:
    """The nearest placement found that meets a requirement.

    Sensors in `moved` are elsewhere; requirements in `breaks` were met and no longer are.
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


def suggestions(study: Study) -> dict[str, Suggestion | None]:
    """Return by requirement that is not met the nearest placement found that meets it.

    None where no placement that was tried is enough. Mounting errors are left out.
    """
    checker, coding = study.checker(), study.coding()
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
