"""The runs of the plan in their order, and their results: a file each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pe_core import InputError
from pe_core.base import Number, Table, dump_json, write_bytes

from ...reproduction.results_file import read_json
from .placements import Placement, placements
from .plan import ACROSS, FIXED, GRID, MIXED, PLAIN, StudyPlan

Json = dict[str, Any]

RUNS = "runs"
"""Folder of the results."""
SCHEMA = 1
FIXED_IN_TURN = 2
"""Placements of the fixed design after each one across hardware, within a seed."""
SHARE = Number(0.0, 1.0)


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


class RunFiles:
    """The results of a plan's runs in a folder.

    Parameters
    ----------
    folder : Path
        The folder of the study.
    plan : StudyPlan

    Attributes
    ----------
    all : list of Run
        The runs of the plan in their order.
    """

    def __init__(self, folder: Path, plan: StudyPlan) -> None:
        self._folder, self.plan = folder / RUNS, plan
        self.all = runs(plan)

    def path(self, run: Run) -> Path:
        """Return the file of a run."""
        return self._folder / f"{run.name}.json"

    def missing(self) -> list[Run]:
        """Return the runs without a file, in their order."""
        return [run for run in self.all if not self.path(run).exists()]

    def write(self, run: Run, data: Json) -> None:
        """Write a run's results atomically."""
        self._folder.mkdir(parents=True, exist_ok=True)
        head = {"schema": SCHEMA, "plan": self.plan.digest, "run": run.name}
        write_bytes(self.path(run), dump_json({**head, **data}).encode())

    def read(self) -> dict[str, Json]:
        """Return the results that are there, by the name of the run, in the order of the plan.

        Raises
        ------
        InputError
            When a file is damaged, or of another plan or run.
        """
        there = {run.name: self.path(run) for run in self.all if self.path(run).exists()}
        return {name: self._checked(path, name) for name, path in there.items()}

    def _checked(self, path: Path, name: str) -> Json:
        data = read_json(path)
        table = Table(data, str(path))
        for key, expected in (("schema", SCHEMA), ("plan", self.plan.digest), ("run", name)):
            if table.raw(key) != expected:
                raise InputError(path, key, str(expected), table.raw(key))
        parts = table.table("placements") if name.startswith(MIXED) else None
        for part in [parts.table(k) for k in parts.names] if parts is not None else [table]:
            part.number("ap", rule=SHARE)
        return data
