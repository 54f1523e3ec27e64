"""What the runs of the study of cameras say."""

from __future__ import annotations

from ...results_file import Json
from ..analysis import (
    HOLDS,
    OPEN,
    REFUTED,
    UNDECIDED,
    DesignResults,
    Results,
    design_table,
    of_runs,
    rounded,
)
from ..plan import CAMERAS
from ..rank_tests import rho_within
from ..runs import seed_by_seed
from .placements import camera_placements
from .plan import CameraPlan

SHOWN = ("rho", "interval", "p", "holm")
"""Figures of a score; eight placements are too few for the others."""


def design_of_cameras(plan: CameraPlan, results: Results) -> DesignResults:
    """Return what the runs have found, as far as they are done."""
    return of_runs(CAMERAS, seed_by_seed(plan.study, camera_placements(plan)), results)


def camera_analysis(plan: CameraPlan, results: Results, scores: Results) -> Json:
    """Return all that follows from the results of the runs, as JSON data."""
    design = design_of_cameras(plan, results)
    found = design_table(plan.study, design, scores)
    rows = {
        score: {key: row[key] for key in SHOWN if key in row}
        for score, row in found["scores"].items()
    }
    found |= {"scores": rows}
    if rows:
        aps, members = design.samples.aps, design.samples.members
        seen = design_table(plan.study, design.all_round(), scores)["scores"]
        found["all_round"] = {score: row["rho"] for score, row in seen.items()}
        found["mean_ap"] = round(float(design.samples.ap.mean()), 4)
        alike = rho_within(aps[:, 0], aps[:, 1], members) if aps.shape[1] > 1 else float("nan")
        found["seed_rho"] = rounded(float(alike))
    return {**found, "verdict": _verdict(plan, found)}


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
