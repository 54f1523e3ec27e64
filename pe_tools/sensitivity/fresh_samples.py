"""Entropies on voxels that the search has not seen, with the error of their differences.

A search picks the placement that is best on its own voxels. So its result is examined on others:
`SAMPLES` scrambled Sobol sequences, each of the same size. Differences of two placements are taken
on the same voxels, and their standard error follows from the scatter over the sequences.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pe_core.base.arrays import Floats
from pe_core.base.values import rounded
from pe_core.scene.rig import Rig
from pe_core.scoring import Evaluator, RigEvaluator
from pe_core.search import Objective, evaluate_all, objective_of
from pe_core.study.condition_table import is_by_ap, on_objects, searched_study
from pe_core.study.study import DEFAULT_SEARCH_SAMPLES, Study

SAMPLES = 4
"""Independent samples: three degrees of freedom for each standard error."""
T_95 = 2.353
"""One-sided 95 % point of Student's t distribution with three degrees of freedom."""
MIN_VOXELS, MIN_SCENES = 2_048, 8
"""Size of one sample at least."""
MAX_VOXELS = 8_192
"""Size of one sample at most: all of them together are half of the default search's voxels. Of a
study's scenes it is half, too, as many as its search evaluates."""
GOLDEN = (0.8191725133961645, 0.6710436067037893, 0.5497004779019703)
"""Powers of the inverse of 1.2207..., the root of x^4 = x + 1 (Roberts' R3 sequence)."""
STEEP_NATS, STEEP_AP = 0.01, 0.001
"""From this cost of one step on, an axis is called steep [nats; expected AP]: a third of what the
default search flatters itself by; half of that by AP, for 600 placements of experiment 3."""
WORTH_SHOWING = 5e-5
"""A smaller difference is 0 in the four decimals that are shown [nats]."""


class Difference(NamedTuple):
    """The difference of two entropies, and its standard error [nats]."""

    mean: float
    stderr: float

    @property
    def is_gain(self) -> bool:
        """Whether the entropy is lower with a confidence of 95 %, and by more than is shown."""
        return self.mean < -max(T_95 * self.stderr, WORTH_SHOWING)

    @property
    def is_loss(self) -> bool:
        """Whether the entropy is higher with a confidence of 95 %, and by more than is shown."""
        return self.mean > max(T_95 * self.stderr, WORTH_SHOWING)

    def to_list(self) -> list[float]:
        """Return it as plain data."""
        return [rounded(self.mean), rounded(self.stderr)]


class FreshSamples:
    """Evaluates rigs on several samples of their own; each rig is evaluated once.

    What is evaluated is what the search minimises: with a tolerance, the mean (or the worst) over
    its mounting errors and failures. Requirements are left out. Differences are taken from the
    reference, the result of the search. `helpers` returns the executor that evaluates rigs.
    """

    def __init__(
        self,
        study: Study,
        reference: Rig,
        objectives: Sequence[Objective] = (),
        helpers: Callable[[], Executor | None] = lambda: None,
    ) -> None:
        self._study, self._helpers = study, helpers
        self._objectives = objectives or fresh_objectives(study)
        self._values: dict[tuple[object, ...], Floats] = {}
        self.reference = reference

    @property
    def size(self) -> int:
        """Voxels (or scenes of objects) of all samples together."""
        return SAMPLES * _size(self._study)

    @property
    def evaluations(self) -> int:
        """How many rigs were evaluated so far."""
        return len(self._values)

    @property
    def steep(self) -> float:
        """From this cost of one step on, an axis is called steep [nats, or expected AP]."""
        return STEEP_AP if is_by_ap(self._study) else STEEP_NATS

    def values(self, rig: Rig) -> Floats:
        """Return the entropy of a rig on each sample, (SAMPLES,) [nats]."""
        self.evaluate([rig])
        return self._values[_key(rig)]

    def evaluate(self, rigs: Iterable[Rig]) -> None:
        """Evaluate rigs side by side, as far as they are not known: `values` then has them."""
        new = {key: rig for rig in rigs if (key := _key(rig)) not in self._values}
        if not new:
            return
        executor, asked = self._helpers(), list(new.values())
        by_sample = [evaluate_all(o, asked, executor=executor) for o in self._objectives]
        for key, found in zip(new, zip(*by_sample, strict=True), strict=True):
            self._values[key] = np.array([each.entropy for each in found])

    def mean(self, rig: Rig) -> Difference:
        """Return the entropy of a rig over all samples, with its standard error [nats]."""
        return _mean(self.values(rig))

    def change(self, rig: Rig, base: Rig | None = None) -> Difference:
        """Return how much higher the entropy of a rig is than that of `base` (the reference)."""
        return _mean(self.values(rig) - self.values(self.reference if base is None else base))


def fresh_objectives(study: Study, workers: int | None = None) -> list[Objective]:
    """Return what evaluates rigs on each fresh sample; it depends on no placement."""
    search = study.search
    evaluators = [_evaluator(study, number, workers) for number in range(SAMPLES)]
    return [objective_of(each, search.tolerance, search.seed) for each in evaluators]


def _key(rig: Rig) -> tuple[object, ...]:
    return tuple((s.name, s.pose.position, s.pose.rpy) for s in rig)


def _mean(values: Floats) -> Difference:
    spread = float(np.std(values, ddof=1))
    return Difference(float(np.mean(values)), spread / len(values) ** 0.5)


def _size(study: Study) -> int:
    """Return the voxels (or scenes) of one sample: fewer where a tolerance has many cases."""
    if searched_study(study).targets.are_objects:
        return max(MIN_SCENES, study.targets.scenes // (2 * SAMPLES))
    cases = len(study.search.tolerance.cases(study.rig)) if study.search.tolerance.is_on else 1
    wanted = (study.search.samples or DEFAULT_SEARCH_SAMPLES) // (2 * SAMPLES)
    fewer = min(wanted, MAX_VOXELS) // max(1, cases // 4)
    least = min(MIN_VOXELS, study.search.samples or MIN_VOXELS)
    return max(least, 1 << max(fewer, 1).bit_length() - 1)  # Sobol sequences want powers of two


def _evaluator(study: Study, number: int, workers: int | None) -> RigEvaluator:
    """Return the evaluator of a sample."""
    problem, size = (study.space, study.prior, study.vehicle), _size(study)
    x, y, z = ((0.5 + (number + 1) * share) % 1.0 for share in GOLDEN)
    targets, kind = searched_study(study).targets, on_objects(study)
    if targets.are_objects:
        return kind(*problem, targets=replace(targets, scenes=size), model=study.model, shift=x)
    return Evaluator(*problem, samples=size, shift=(x, y, z), model=study.model, workers=workers)
