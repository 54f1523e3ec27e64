"""A look from outside: Place3D's segmentation networks, ten placements with four networks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import pe_core as pe
from pe_core import InputError
from pe_core.base import dump_json, write_bytes
from pe_core.scoring.targets import ObjectEvaluator, TargetRule

from ..published.findings import p_text, rho_text
from ..published.published import DEGREES, Paper, paper_of
from ..published.ranks import holm, mean_ranks, standard_ranks
from ..published.scores import body_of
from ..results_file import read_json
from ..wording import joined, table
from .plan import StatisticsRule
from .rank_tests import SAME
from .scores import SPACE

Json = dict[str, Any]

TABLE = Path(__file__).parents[1] / "published" / "data" / "place3d_segmentation.json"
SCORES = "segmentation.json"
CONDITIONS = {"clean": "clean", "adverse_mean": "mean of the adverse conditions"}


@cache
def published() -> Json:
    """Return the published placements and mIoU."""
    return read_json(TABLE)


def segmentation_scores(folder: Path, report: Callable[[str], None]) -> dict[str, Json]:
    """Return the scores of the published placements by name; what is missing is computed."""
    path = folder / SCORES
    names = list(published()["placements"])
    scores: dict[str, Json] = read_json(path) if path.exists() else {}
    if not set(scores) <= set(names):
        raise InputError(path, "placements", f"some of {', '.join(names)}", ", ".join(scores))
    if missing := [name for name in names if name not in scores]:
        score = _scorer()
        for name in missing:
            scores[name] = score(name)
            report(f"scored {name} of Place3D")
        write_bytes(path, dump_json({name: scores[name] for name in names}).encode())
    return scores


def _scorer() -> Callable[[str], Json]:
    """Return a function that scores a placement, as the page on published detectors does."""
    body, road = body_of("box"), pe.Prior.road()
    voxels = pe.Evaluator(SPACE, road, body, workers=1)
    rules = {traffic: TargetRule("objects", traffic) for traffic in (False, True)}
    objects = {t: ObjectEvaluator(SPACE, road, body, targets=rule) for t, rule in rules.items()}
    paper: Paper = replace(paper_of("place3d"), placements=published()["placements"])

    def score(name: str) -> Json:
        rig = paper.rig(name, DEGREES)
        of_voxels = voxels.score(rig)
        found = {"perception entropy, road prior": -of_voxels.entropy}
        found["coverage"] = of_voxels.coverage
        for traffic, evaluator in objects.items():
            of_objects = evaluator.score(rig).objects
            assert of_objects is not None
            found[f"expected AP{', in traffic' if traffic else ''}"] = of_objects.ap
        found["mean height"] = paper.height(name)
        return found

    return score


def section(scores: Mapping[str, Json], rule: StatisticsRule, seed: int) -> str:
    """Return the section of the page."""
    names = list(published()["placements"])
    tables = "\n\n".join(
        f"### mIoU, {title}\n\n{_table(condition, scores, rule, seed)}"
        for condition, title in CONDITIONS.items()
    )
    networks = joined(list(published()["miou"]["clean"]))
    return f"""
## From outside: segmentation in Place3D

{len(names)} placements of four LiDARs of 16 channels with {networks}. Source: {published()["source"]}. One training a placement,
no error bars; seven of the placements are also those of Place3D's detectors. Rolls are read in degrees, the body is the
box of the page on [published detectors](../README.md). Mean rho over the networks, two-sided p by random permutations of the
placements, Holm's correction for the scores.

{tables}
"""


def _table(condition: str, scores: Mapping[str, Json], rule: StatisticsRule, seed: int) -> str:
    rows = correlations(condition, scores, rule, seed)
    adjusted = holm([row["p"] for row in rows.values()])
    lines = [
        [name, rho_text(row["rho"]), p_text(row["p"]), p_text(p)]
        for (name, row), p in zip(rows.items(), adjusted, strict=True)
    ]
    return table(["score", "mean rho", "p", "p after Holm"], lines)


def correlations(
    condition: str, scores: Mapping[str, Json], rule: StatisticsRule, seed: int
) -> dict[str, Json]:
    """Return mean rho over the networks and its p, by score."""
    names = list(published()["placements"])
    mious = [[row[n] for n in names] for row in published()["miou"][condition].values()]
    of_networks = mean_ranks(mious)
    rows = {}
    for score in scores[names[0]]:
        ranks = standard_ranks([scores[n][score] for n in names])
        if ranks is None:
            raise InputError(SCORES, score, "values that differ", "one value")
        rng = np.random.default_rng([seed, 4])
        tiled = np.broadcast_to(ranks, (rule.permutations, len(names)))
        chance = np.abs((rng.permuted(tiled, axis=1) * of_networks).sum(axis=1))
        rho = float((ranks * of_networks).sum())
        p = (1 + int((chance >= abs(rho) - SAME).sum())) / (1 + rule.permutations)
        rows[score] = {"rho": rho, "p": p}
    return rows
