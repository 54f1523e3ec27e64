"""The sensitivity analysis of a search's result: what it computes, within which budget."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from pe_core.scene.rig import Rig
from pe_core.scoring import RigJudge
from pe_core.scoring.score import rounded
from pe_core.search import AXES, objective_of
from pe_core.search.goals import FULL, OFF
from pe_core.study.objective_search import is_by_ap
from pe_core.study.objective_setting import EXPECTED_AP
from pe_core.study.study import Study

from .archive import Archive
from .flatness import FAR, NEAR, AxisCost, flatness
from .fresh_samples import Difference, FreshSamples
from .moves import Neighbourhood
from .optima import BETWEEN, DESCENT, EXAMINED, MAX_RUNNERS_UP, Basins, Endings
from .shadow_prices import ShadowPrice, Unmet, shadow_prices, with_sizes
from .sizes import SizePricing

SHARE = 8
"""The analysis evaluates at most the search's evaluations divided by this."""
ENDINGS_NEED = EXAMINED * (1 + len(BETWEEN)) + MAX_RUNNERS_UP * DESCENT
"""Evaluations that the endings of a search take at most, about."""


@dataclass(frozen=True, slots=True)
class Flattery:
    """How much the search's own sample flattered its result.

    Attributes
    ----------
    on_search : float
        Entropy of the result on the voxels that the search minimised it on [nats]; of a search by
        expected AP the value that it minimised: minus the AP.
    on_fresh : Difference
        The same on fresh voxels (or scenes), and the standard error.
    """

    on_search: float
    on_fresh: Difference

    @property
    def nats(self) -> float:
        """How much worse the result is on fresh voxels [nats, or expected AP]."""
        return rounded(self.on_fresh.mean - self.on_search)

    def to_dict(self, sign: float = 1.0) -> dict[str, Any]:
        """Return it as plain JSON data; values times `sign`."""
        mean, stderr = self.on_fresh.to_list()
        return {"on_search": sign * self.on_search, "on_fresh": sign * mean, "stderr": stderr}


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """How sure a search is of its result.

    Attributes
    ----------
    voxels : int
        Voxels (or scenes of objects) that the search has not seen, on which all is evaluated.
    evaluations : int
        Rigs that were evaluated.
    axes : tuple of AxisCost
        What a step costs, by sensor and axis.
    prices : tuple of ShadowPrice
        Active constraints; one without a constraint says that a longer search would gain.
    flattery : Flattery
    endings : Endings or None
        Where the starts ended; None where the budget was too small.
    by_ap : bool
        Whether the search was by expected AP: costs and gains are then differences of the AP, and
        positive is still worse.
    """

    voxels: int
    evaluations: int
    axes: tuple[AxisCost, ...]
    prices: tuple[ShadowPrice, ...]
    flattery: Flattery
    endings: Endings | None
    by_ap: bool = False

    @property
    def sign(self) -> float:
        """Values times this are figures for people."""
        return -1.0 if self.by_ap else 1.0

    @property
    def active(self) -> tuple[ShadowPrice, ...]:
        """The active constraints."""
        return tuple(price for price in self.prices if price.constraints)

    @property
    def unfinished(self) -> ShadowPrice | None:
        """An allowed step that would be better: the search was too short for it."""
        return next((price for price in self.prices if not price.constraints), None)

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data, as result.json holds it."""
        return {
            "voxels": self.voxels,
            "evaluations": self.evaluations,
            "axes": [each.to_dict() for each in self.axes],
            "constraints": [each.to_dict() for each in self.prices],
            "flattery": self.flattery.to_dict(self.sign),
            "endings": None if self.endings is None else self.endings.to_dict(),
            **({"objective": EXPECTED_AP} if self.by_ap else {}),
        }


def is_analysed(study: Study) -> bool:
    """Return whether the result of a long search is analysed.

    A search over states and weathers minimises what no fresh sample has.
    """
    return study.search.goals.sensitivity != OFF and study.search.conditions is None


def budget_of(study: Study, evaluations: int) -> tuple[tuple[float, ...], bool] | None:
    """Return the steps of the table and whether the endings are examined; None for no analysis.

    Parameters
    ----------
    study : Study
    evaluations : int
        Of the search. Short searches have less, so that the analysis does not outlast them.
    """
    wanted, sensors = study.search.goals.sensitivity, len(study.rig)
    if not is_analysed(study):
        return None
    if wanted == FULL:
        return (NEAR, FAR), True
    left = evaluations // SHARE
    near = 4 * len(AXES) * sensors  # lone and design moves, back and forth
    if left < near:
        return None
    far = 2 * len(AXES) * sensors
    steps = (NEAR, FAR) if left >= near + far else (NEAR,)
    return steps, left >= near + far + ENDINGS_NEED


def _for_sizes(study: Study, evaluations: int, with_endings: bool) -> float:
    """Return up to how many rigs may be evaluated before what sizes gain is left out."""
    if study.search.goals.sensitivity == FULL:
        return math.inf
    return evaluations // SHARE - (ENDINGS_NEED if with_endings else 0)


def analyse(
    start: Study,
    best: Study,
    searched_on: RigJudge,
    archive: Archive,
    evaluations: int,
    samples: FreshSamples,
    goes_on: Callable[[], bool] = lambda: True,
) -> Sensitivity | None:
    """Return the sensitivity analysis of a search's result; None where its budget is too small.

    The result depends on the study alone, not on workers or time.

    Parameters
    ----------
    start, best : Study
        The study as it was given, and with the result of the search.
    searched_on : RigJudge
        What the search evaluated its last candidates with.
    archive : Archive
        What the search evaluated.
    evaluations : int
        How many.
    samples : FreshSamples
        Of the study with the result, which is their reference.
    goes_on : callable
        False: the user has stopped the job; the analysis is given up.
    """
    parts = budget_of(best, evaluations)
    if parts is None or not goes_on():
        return None
    steps, with_endings = parts
    space = start.search_space()
    around = Neighbourhood(best.rig, space)
    axes = []
    for row in flatness(samples, around, steps):
        axes.append(row)
        if not goes_on():
            return None
    prices = shadow_prices(samples, around, axes, _unmet_by(best))
    budget = _for_sizes(best, evaluations, with_endings)
    prices = with_sizes(prices, SizePricing(samples, around), lambda: samples.evaluations < budget)
    endings = Basins(samples, space).endings(archive.placements()) if with_endings else None
    return Sensitivity(
        samples.size,
        samples.evaluations,
        tuple(axes),
        prices,
        _flattery(best, searched_on, samples),
        endings,
        is_by_ap(best),
    )


def _flattery(best: Study, searched_on: RigJudge, samples: FreshSamples) -> Flattery:
    search = best.search
    objective = objective_of(searched_on, search.tolerance, search.seed)
    return Flattery(objective.entropy(best.rig), samples.mean(best.rig))


def _unmet_by(study: Study) -> Unmet | None:
    """Return what names the kept requirements that a rig does not meet; None without any."""
    if not study.search.requirements or not study.requirements:
        return None
    checker = study.checker()
    names = [each.name for each in checker.requirements]

    def unmet(rig: Rig) -> list[str]:
        return [n for n, off in zip(names, checker.shortfalls(rig), strict=True) if off]

    return unmet
