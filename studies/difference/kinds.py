"""The kinds of rigs that have pairs: our own placements, published ones, and camera rigs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from pe_core import InputError
from pe_core.search.figures import COVERAGE, ENTROPY, TRAFFIC_AP

from ..cameras import scores as of_cameras
from ..cameras.published_rigs import RIGS, PublishedRigs, read_rigs
from ..detectors import scores as of_own
from ..detectors.analysis import DesignResults, of_mixed, of_runs, plain_design
from ..detectors.placements import good_placements
from ..detectors.plan import FIXED, GOOD, LAYOUTS, SECOND, full_plan, full_second_plan
from ..detectors.runs import RunFiles, parts_of, runs
from ..detectors.scores import placement_scores
from ..detectors.second.analysis import good_runs
from ..published.correlations import ALL, MAIN_CLASS, RankComparison
from ..published.scores import CANDIDATES, CLEAN, DEGREES, papers
from ..ranks import PlacementSamples
from ..results_file import RESULTS, Json, print_progress, read_json, values_of
from .pairs import Group
from .worth import Kind

VALIDITY = Path(__file__).parents[2] / "docs/validity"
CAMERA_RIGS = "cameras"
LIDARS = {
    "lidars_fixed": "LiDARs, one vehicle",
    "lidars_good": "good placements of LiDARs, one vehicle",
    "lidars_layouts": "LiDARs in real layouts, one vehicle",
}
"""Kinds of our own placements, as they are called."""
SCORES = {ENTROPY: of_own.PRIMARY, TRAFFIC_AP: of_own.EXPECTED_AP, COVERAGE: of_own.COVERAGE}
"""Scores by their figure in the engine, and their names in our own and the published study."""
CAMERA_SCORES = {
    ENTROPY: of_cameras.ENTROPY,
    TRAFFIC_AP: of_cameras.EXPECTED_AP,
    COVERAGE: of_cameras.COVERAGE,
}


def own_kinds() -> list[Kind]:
    """Return the kinds of our own placements, from the stored results of their runs."""
    first = full_plan()
    folder = VALIDITY / "own"
    done = RunFiles(folder, first, runs(first)).read()
    second = full_second_plan()
    parts = parts_of(second)
    wanted = [run for name in (GOOD, LAYOUTS) for run in parts[name]]
    more = RunFiles(folder / SECOND, second, wanted).read()
    selecting = second.second.good.seeds[0]
    better = [r for r in good_runs(second, parts[GOOD], more) if r.seed != selecting]
    kept = {
        FIXED: placement_scores(first, [], folder, print_progress),
        GOOD: placement_scores(second, [], folder / SECOND, print_progress),
    }
    designs = [
        (plain_design(first, [FIXED], done), kept[FIXED]),
        (of_runs(GOOD, better, more), kept[GOOD]),
        (of_mixed(LAYOUTS, parts[LAYOUTS], good_placements(second), more), kept[GOOD]),
    ]
    pages = ("own", "own/second", "own/second")
    return [
        Kind(name, label, f"docs/validity/{page}", groups_of(design, scores))
        for (name, label), page, (design, scores) in zip(
            LIDARS.items(), pages, designs, strict=True
        )
    ]


def groups_of(design: DesignResults, scores: Mapping[str, Json]) -> list[Group]:
    """Return a group for each vehicle of a design; AP is the mean over its seeds."""
    values = design.all_values(scores)
    samples: PlacementSamples = design.samples
    return [
        Group(
            str(samples.groups[index[0]]),
            {figure: values[name][index] for figure, name in SCORES.items()},
            samples.ap[index][None, :],
        )
        for index in samples.members
    ]


def published_kind() -> Kind:
    """Return the placements of both papers: clean, rolls in degrees, cars by each detector."""
    values = values_of(read_json(VALIDITY / "published" / RESULTS))
    by_name = {score.name: score for score in CANDIDATES}
    groups = []
    for paper in papers():
        comparison = RankComparison(
            paper, condition=CLEAN, cls=MAIN_CLASS, reading=DEGREES, selection=ALL
        )
        rows = {
            figure: np.array(comparison.score_values(by_name[name], values))
            for figure, name in SCORES.items()
        }
        groups.append(Group(paper.id, rows, np.array(list(comparison.ap.values()))))
    return Kind("lidars_published", "published LiDARs", "docs/validity/published", groups)


def camera_kind(rigs: PublishedRigs, found: Json) -> Kind:
    """Return the camera rigs: cars by each detector, with the scores of their study's results.

    `InputError` where these are of another file.
    """
    if found["data"] != rigs.digest:
        raise InputError("cameras", "data", f"the file with SHA-256 {found['data']}", rigs.digest)
    scored = {name: found["scores"][name] for name in RIGS}
    rows = {}
    for figure, name in CAMERA_SCORES.items():
        values = of_cameras.values_of_score(scored, of_cameras.CARS_OUTCOME, name)
        assert values is not None  # these are defined for every rig
        rows[figure] = values
    aps = np.array([own[of_cameras.CARS_OUTCOME] for own in rigs.by_detector.values()])
    groups = [Group("14 rigs", rows, aps)]
    outcome = of_cameras.CARS_OUTCOME
    numbers = [len(rig.rig) for rig in rigs.rigs]
    return Kind(
        CAMERA_RIGS,
        "cameras",
        "docs/validity/cameras",
        groups,
        of_class=of_cameras.CLASS_OF[outcome],
        within=of_cameras.WITHIN_M[outcome],
        sensors=(min(numbers), max(numbers)),
    )


def camera_kind_of(path: Path) -> Kind:
    """Return the camera rigs of a file, with the stored results of their study."""
    return camera_kind(read_rigs(path), read_json(VALIDITY / "cameras" / RESULTS))
