"""What a search improves: `[optimize] objective = "entropy"` or `"expected_ap"`.

A search minimises one value. By expected AP it is minus the expected AP of objects in traffic, so
that bounds and cutoffs work as for entropy. Requirements, tolerance and conditions wrap either.
"""

from __future__ import annotations

from dataclasses import replace

from ..base.errors import InputError
from ..scene.rig import Rig
from ..scoring import RigEvaluator
from ..scoring.targets import OBJECTS, ObjectEvaluator
from ..scoring.targets.object_evaluator import MByName
from .objective_setting import EXPECTED_AP
from .study import Study


class ExpectedApEvaluator(ObjectEvaluator):
    """An `ObjectEvaluator` whose value of a rig is minus its expected AP; scores are the same.

    Objects and the vehicle occlude and add nothing, so without occlusion the AP is no lower:
    `evaluate` has lower bounds as for entropy.
    """

    def _value(self, rig: Rig, m: MByName) -> float:
        return -self._sums.expected_ap(self._fused.entropies(rig, m)[0])


def is_by_ap(study: Study) -> bool:
    """Whether a study's search maximises the expected AP of objects in traffic."""
    return study.search.objective == EXPECTED_AP


def on_objects(study: Study) -> type[ObjectEvaluator]:
    """Return what evaluates candidates of a study's search on objects."""
    return ExpectedApEvaluator if is_by_ap(study) else ObjectEvaluator


def searched_study(study: Study) -> Study:
    """Return the study that a search evaluates candidates of: by expected AP, one in traffic."""
    if not is_by_ap(study):
        return study
    target, targets = study.search.goals.stop.target, study.targets
    if target is not None and not 0.0 <= target <= 1.0:
        expected = f'an expected AP, 0 to 1, with objective = "{EXPECTED_AP}"'
        raise InputError("optimize", "stop.target", expected, target)
    return replace(study, targets=replace(targets, targets=OBJECTS, traffic=True), samples=0)


def search_evaluator(
    study: Study, samples: int | None = None, workers: int | None = None
) -> RigEvaluator:
    """Return the evaluator of a search's candidates; arguments are those of `Study.evaluator`."""
    return searched_study(study).evaluator(samples, workers, on_objects(study))
