"""The runs of the plan in their order, and the files of their results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from pe_core.base import Table

from .placements import Placement, placements
from .plan import ACROSS, FIXED, GRID, MIXED, PLAIN, StudyPlan
from .result_files import ResultFiles, check_ap

FIXED_IN_TURN = 2
"""Placements of the fixed design after each one across hardware, within a seed."""


@dataclass(frozen=True, slots=True)
class Run:
    """A detector trained with a seed, for one placement or (placement None) for many.

    Attributes
    ----------
    placement : Placement or None
    world, detector : str
    seed : int
    """

    placement: Placement | None
    world: str
    detector: str
    seed: int

    @property
    def name(self) -> str:
        """Its name, which is that of its file."""
        what = self.placement.name if self.placement else MIXED
        step = "" if (self.world, self.detector) == (PLAIN, GRID) else self.step + "-"
        return f"{step}{what}-s{self.seed}"

    @property
    def step(self) -> str:
        """World and detector."""
        return f"{self.world}-{self.detector}"

    @property
    def design(self) -> str:
        """Design of the placement."""
        return self.placement.design if self.placement else MIXED


def runs(plan: StudyPlan) -> list[Run]:
    """Return all runs of a plan in their order."""
    return [*_main_runs(plan), *_step_runs(plan)]


def _main_runs(plan: StudyPlan) -> Iterator[Run]:
    """Yield the runs of the designs, seed by seed: an early stop leaves whole seeds."""
    drawn = placements(plan)
    ordered = [*_in_turn(drawn, plan.vehicles), None]
    for seed in plan.training.seeds:
        for placement in ordered:
            yield Run(placement, PLAIN, GRID, seed)


def _in_turn(drawn: Sequence[Placement], vehicles: Sequence[str]) -> list[Placement]:
    """Return placements of both designs by turns, and of all vehicles by turns."""
    across, fixed = (
        _by_turns([[p for p in drawn if p.design == d and p.vehicle == v] for v in vehicles])
        for d in (ACROSS, FIXED)
    )
    ordered = []
    while across or fixed:
        ordered += [across.pop(0)] if across else []
        ordered += fixed[:FIXED_IN_TURN]
        del fixed[:FIXED_IN_TURN]
    return ordered


def _by_turns(groups: Sequence[Sequence[Placement]]) -> list[Placement]:
    longest = max((len(group) for group in groups), default=0)
    return [group[k] for k in range(longest) for group in groups if k < len(group)]


def _step_runs(plan: StudyPlan) -> Iterator[Run]:
    chosen = step_placements(plan)
    for step in plan.steps:
        for seed in step.seeds:
            for placement in chosen:
                yield Run(placement, step.world, step.detector, seed)


def step_placements(plan: StudyPlan) -> list[Placement]:
    """Return the placements of the steps towards reality."""
    drawn = placements(plan)
    fixed = [
        [p for p in drawn if p.design == FIXED and p.vehicle == v and p.all_round]
        for v in plan.vehicles
    ]
    across = [p for p in drawn if p.design == ACROSS and p.vehicle in plan.step_across]
    return [*_by_turns([group[: plan.step_fixed] for group in fixed]), *across]


class RunFiles(ResultFiles[Run]):
    """The results of a plan's runs in the folder of the study."""

    def __init__(self, folder: Path, plan: StudyPlan) -> None:
        super().__init__(folder, plan.digest, runs(plan))
        self.plan = plan

    def _check(self, run: Run, table: Table) -> None:
        parts = table.table("placements") if run.placement is None else None
        for part in [parts.table(k) for k in parts.names] if parts is not None else [table]:
            check_ap(part)
