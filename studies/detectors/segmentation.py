"""A look from outside: Place3D's segmentation networks, ten placements with four networks."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

import pe_core as pe
from pe_core import InputError
from pe_core.base import dump_json, write_bytes
from pe_core.scoring.targets import ObjectEvaluator, TargetRule

from ..pages import p_text, rho_text
from ..published.published import DEGREES, Paper, paper_of
from ..published.scores import body_of
from ..ranks import SAME, holm, mean_ranks, standard_ranks
from ..results_file import Json, read_json
from .plan import StatisticsRule
from .scores import SPACE

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


def tables(scores: Mapping[str, Json], rule: StatisticsRule, seed: int) -> Json:
    """Return for the page: the lines of its table, and what they are of."""
    by_condition = [correlations(condition, scores, rule, seed) for condition in CONDITIONS]
    adjusted = [holm([row["p"] for row in rows.values()]) for rows in by_condition]
    lines = []
    for k, name in enumerate(by_condition[0]):
        cells = [
            f"{rho_text(rows[name]['rho'])} ({p_text(rows[name]['p'])}, {p_text(corrected[k])})"
            for rows, corrected in zip(by_condition, adjusted, strict=True)
        ]
        lines.append([name, *cells])
    return {
        "lines": lines,
        "titles": ["score", *(f"mIoU, {title}" for title in CONDITIONS.values())],
        "placements": len(published()["placements"]),
        "networks": list(published()["miou"]["clean"]),
        "source": published()["source"],
    }


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
        if not ranks.any():
            raise InputError(SCORES, score, "values that differ", "one value")
        rng = np.random.default_rng([seed, 4])
        tiled = np.broadcast_to(ranks, (rule.permutations, len(names)))
        chance = np.abs((rng.permuted(tiled, axis=1) * of_networks).sum(axis=1))
        rho = float((ranks * of_networks).sum())
        p = (1 + int((chance >= abs(rho) - SAME).sum())) / (1 + rule.permutations)
        rows[score] = {"rho": rho, "p": p}
    return rows
