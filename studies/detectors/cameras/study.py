"""The runs of the study of cameras, their results, and what follows from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..analysis import (
    CAMERAS,
    HOLDS,
    OPEN,
    REFUTED,
    UNDECIDED,
    DesignResults,
    design_table,
    of_runs,
)
from ..posed_sensors import PosedSensors
from ..rank_tests import rho_within
from ..result_files import ResultFiles
from .placements import camera_placements
from .plan import CameraPlan

Json = dict[str, Any]

SHOWN = ("rho", "interval", "p", "holm")
"""Figures of a score; eight placements are too few for the others."""


@dataclass(frozen=True, slots=True)
class CameraRun:
    """A detector trained with a seed for one placement."""

    placement: PosedSensors
    seed: int

    @property
    def name(self) -> str:
        """Its name, which is that of its file."""
        return f"{self.placement.name}-s{self.seed}"


def camera_runs(plan: CameraPlan) -> list[CameraRun]:
    """Return all runs in their order: seed by seed."""
    seeds = plan.study.training.seeds
    return [CameraRun(placement, seed) for seed in seeds for placement in camera_placements(plan)]


class CameraFiles(ResultFiles[CameraRun]):
    """The results of the runs, in a folder of their own in that of the study."""

    def __init__(self, folder: Path, plan: CameraPlan) -> None:
        super().__init__(folder / CAMERAS, plan.digest, camera_runs(plan))


def design_of_cameras(plan: CameraPlan, results: Mapping[str, Json]) -> DesignResults:
    """Return what the runs have found, as far as they are done."""
    return of_runs(CAMERAS, camera_runs(plan), results)


def camera_analysis(
    plan: CameraPlan, results: Mapping[str, Json], scores: Mapping[str, Json]
) -> Json:
    """Return all that follows from the results of the runs, as JSON data.

    Parameters
    ----------
    plan : CameraPlan
    results : mapping
        Results by the name of the run.
    scores : mapping
        Scores by the name of the placement, of all placements with results.
    """
    design = design_of_cameras(plan, results)
    found = _shown(design_table(plan.study, design, scores))
    if found["scores"]:
        found["all_round"] = _of_all_round(plan, design, scores)
        found["mean_ap"] = round(float(design.samples.ap.mean()), 4)
        found["seed_rho"] = _seed_rho(design)
    return {**found, "verdict": _verdict(plan, found)}


def _shown(found: Json) -> Json:
    rows = {
        score: {key: row[key] for key in SHOWN if key in row}
        for score, row in found["scores"].items()
    }
    return {**found, "scores": rows}


def _of_all_round(
    plan: CameraPlan, design: DesignResults, scores: Mapping[str, Json]
) -> dict[str, float | None]:
    """Return rho of each score among the placements that see all round."""
    index = np.flatnonzero([p.all_round for p in design.chosen])
    samples = design.samples.subset(index)
    part = DesignResults(
        design.name, [design.chosen[k] for k in index], samples, len(index), len(index)
    )
    rows = design_table(plan.study, part, scores)["scores"]
    return {score: row["rho"] for score, row in rows.items()}


def _seed_rho(design: DesignResults) -> float | None:
    """Return rho of the AP of the first two seeds; None with one seed."""
    aps, members = design.samples.aps, design.samples.members
    if aps.shape[1] < 2:
        return None
    return round(float(rho_within(aps[:, 0], aps[:, 1], members)), 4)


def is_too_noisy(plan: CameraPlan, found: Json) -> bool:
    """Whether the detectors find too little, or their seeds agree too little, for a statement."""
    seed_rho = found.get("seed_rho")
    return seed_rho is None or seed_rho < plan.min_seed_rho or bool(found["mean_ap"] < plan.min_ap)


def _verdict(plan: CameraPlan, found: Json) -> str:
    rule = plan.study.statistics
    if found["done"] < found["planned"] or not found["scores"]:
        return OPEN
    primary = found["scores"][rule.primary]
    if is_too_noisy(plan, found) or primary["p"] >= rule.alpha:
        return UNDECIDED
    return HOLDS if primary["rho"] > 0.0 else REFUTED
