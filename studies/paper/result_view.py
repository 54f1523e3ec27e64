"""Complete results, for the page: scores, searches, claims, and where searches end."""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from typing import Any

from pe_core.metric import H_BLIND

from ..results_file import CompleteResults
from ..wording import ABOUT_M, APART_DEG, APART_M, MOUNT_M
from .paper import HALF_LENGTH_M, HALF_WIDTH_M, PRIORS, ROOF_M, ROW, Position, study_of
from .plan import CAMERA_ROWS, best_search, effort_from_dict

MIN_SECONDS = 1e-3
"""The smallest step of a duration in results.json."""
ROOF_ROWS, CORNER_ROWS = ("1_pandar64", "1_hdl64e"), ("3_default", "3_front")
"""Rows of LiDARs above a car's roof, and at a bus's corners."""
SEARCHED_PAIRS = {
    "1": ROOF_ROWS,
    "2": CAMERA_ROWS,
    "3 default": ("3_default", "3_default"),
    "3 front": ("3_front", "3_front"),
    "4": ("4_cameras", "3_front"),
}
"""The rows whose searches a claim compares; experiment 3: two pilots of one row, a search each."""
CLEAR = 2.0
"""Standard deviations from which two searches differ by more than chance."""

PositionBySensor = Mapping[str, Position]


class ReproductionResults(CompleteResults):
    """Complete results of ``python -m studies.paper``."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        super().__init__(data)
        self.claims: Sequence[Mapping[str, Any]] = data["claims"]
        self.values = {name: entry["value"] for name, entry in data["results"].items()}
        self.effort = effort_from_dict(self.made["effort"])

    def __getitem__(self, name: str) -> Any:
        return self.values[name]

    def with_prefix(self, prefix: str) -> dict[str, Any]:
        """Return the values whose task name begins with a prefix, by the rest of the name."""
        return {k.removeprefix(prefix): v for k, v in self.values.items() if k.startswith(prefix)}

    def entropy(self, row: str, prior: str = PRIORS[0], kind: str = "printed") -> float:
        """Return the entropy of a row's rig at the printed placement [nats]."""
        entropy: float = self.values[f"{kind}/{row}/{prior}"]["entropy"]
        return entropy

    def entropy_in_view(self, row: str, prior: str) -> float:
        """Return the mean entropy of the voxels that a row's rig sees, at the printed placement."""
        score = self.values[f"printed/{row}/{prior}"]
        coverage: float = score["coverage"]
        return (score["entropy"] - (1.0 - coverage) * H_BLIND) / coverage

    def was_searched(self, row: str, prior: str = PRIORS[0]) -> bool:
        """Return whether a row was searched."""
        return bool(best_search(self.values, self.effort, row, prior))

    def searched(self, rows: Sequence[str]) -> list[str]:
        """Return the rows that were searched, of some rows."""
        return [row for row in rows if self.was_searched(row)]

    def best(self, row: str, prior: str = PRIORS[0]) -> Mapping[str, Any]:
        """Return the value of a row's best search."""
        name = best_search(self.values, self.effort, row, prior)
        value: Mapping[str, Any] = self.values[name]
        return value

    def best_start(self, row: str, prior: str = PRIORS[0]) -> str:
        """Return the start of a row's best search."""
        return best_search(self.values, self.effort, row, prior).split("/")[3]

    def searches(self, row: str, prior: str = PRIORS[0]) -> list[Mapping[str, Any]]:
        """Return the values of the searches of all seeds from the best start."""
        return list(
            self.with_prefix(f"search/{row}/{prior}/{self.best_start(row, prior)}/").values()
        )

    def final_placements(self, row: str, prior: str = PRIORS[0]) -> list[Mapping[str, Any]]:
        """Return the placements at the end of the searches of all seeds from the best start."""
        return [search["placements"] for search in self.searches(row, prior)]

    def final_positions(self, row: str, prior: str = PRIORS[0]) -> list[PositionBySensor]:
        """Return the sensors' positions [m] at the end of the same searches."""
        return [
            {name: tuple(pose["position"]) for name, pose in placement.items()}
            for placement in self.final_placements(row, prior)
        ]

    def mean_of_seeds(self, row: str, prior: str = PRIORS[0]) -> str:
        """Return mean and standard deviation of the entropy over the seeds, as text."""
        entropies = [search["entropy"] for search in self.searches(row, prior)]
        if len(entropies) < 2:
            return ""
        return f"{statistics.mean(entropies):.3f} ± {statistics.stdev(entropies):.3f}"

    def search_seconds(self) -> list[float]:
        """Return the durations of all searches [s], none of them 0."""
        seconds = [s for name, s in self.seconds.items() if name.startswith("search/")]
        return [max(s, MIN_SECONDS) for s in seconds]

    def is_decided(self, claim: Mapping[str, Any]) -> bool:
        """Return whether a claim's difference is larger than what chance does to its searches.

        It is, if it is more than `CLEAR` standard deviations of the difference of two searches;
        the deviation of one is that over the seeds of its row. Printed placements have none.
        """
        if claim["where"] != "searched":
            return True
        difference = claim["worse_entropy"] - claim["better_entropy"] - claim["by"]
        deviations = self.searched_deviations(claim["experiment"], claim["prior"])
        return bool(abs(difference) > CLEAR * math.hypot(*deviations))

    def searched_deviations(self, experiment: str, prior: str) -> tuple[float, float]:
        """Return the standard deviation over the seeds for both searches of a claim [nats].

        Zero where a row has one seed: nothing is known then.
        """
        first, second = (
            [search["entropy"] for search in self.searches(row, prior)]
            for row in SEARCHED_PAIRS[experiment]
        )
        deviations = [statistics.stdev(v) if len(v) > 1 else 0.0 for v in (first, second)]
        return deviations[0], deviations[1]

    def priors_holding(self, experiment: str, where: str) -> tuple[list[str], list[str]]:
        """Return the priors under which a claim holds, and those under which it does not.

        Those under which the searches do not decide it are in neither list.
        """
        claims = [c for c in self.claims if (c["experiment"], c["where"]) == (experiment, where)]
        claims = [c for c in claims if self.is_decided(c)]
        holding, others = (
            [c["prior"] for c in claims if c["holds"] is holds] for holds in (True, False)
        )
        return holding, others

    def is_reversed(self, experiment: str, priors: Sequence[str]) -> bool:
        """Return whether the rig that the paper finds worse scores lower at its placements."""
        claims = [self.printed_claim(experiment, prior) for prior in priors]
        return all(c["worse_entropy"] < c["better_entropy"] for c in claims)

    def claim(
        self, experiment: str, where: str, prior: str = PRIORS[0]
    ) -> Mapping[str, Any] | None:
        """Return a claim, with its entropies and whether it holds; None where there is none."""
        key = (experiment, where, prior)
        claims = (c for c in self.claims if (c["experiment"], c["where"], c["prior"]) == key)
        return next(claims, None)

    def printed_claim(self, experiment: str, prior: str = PRIORS[0]) -> Mapping[str, Any]:
        """Return a claim on the placements that the paper prints."""
        claim = self.claim(experiment, "printed", prior)
        assert claim is not None
        return claim


def row_label(row: str) -> str:
    """Return a row's number and name."""
    return f"{ROW[row].experiment} {ROW[row].label}"


def placement_text(placements: Mapping[str, Any]) -> str:
    """Return x, y, z [m] and pitch [deg] of every sensor, as text."""
    return "; ".join(
        "({:.2f}, {:.2f}, {:.2f}), {:.1f}°".format(*p["position"], p["rotation"][1])
        for p in placements.values()
    )


def printed_placement_text(row: str) -> str:
    """Return the placement that the paper prints for a row, as text."""
    rig = study_of(row).rig
    return placement_text(
        {s.name: {"position": s.pose.position, "rotation": s.pose.rotation_deg} for s in rig}
    )


def printed_positions(row: str) -> PositionBySensor:
    """Return the sensors' positions that the paper prints for a row [m]."""
    return {s.name: s.pose.position for s in study_of(row).rig}


def max_height(row: str) -> float:
    """Return the greatest height that a search allows a row's sensors [m]."""
    bounds = study_of(row).search_space().bounds
    return max(axes["z"][1] for axes in bounds.values())


def above_roof(positions: PositionBySensor) -> bool:
    """Return whether all sensors are above the sedan's roof."""
    return all(position[2] > ROOF_M for position in positions.values())


def corners_of(positions: PositionBySensor) -> list[tuple[int, int]] | None:
    """Return the bus's corners with a sensor, by the signs of x and y; None if one is at none.

    A pair of corners and its mirror image give the same result: the one with the first on the left.
    """
    corners = sorted((1 if x > 0.0 else -1, 1 if y > 0.0 else -1) for x, y, _ in positions.values())
    for x, y, _ in positions.values():
        if max(abs(abs(x) - HALF_LENGTH_M), abs(abs(y) - HALF_WIDTH_M)) > ABOUT_M:
            return None
    return max(corners, sorted((x, -y) for x, y in corners))


def ends_like_the_paper(results: ReproductionResults, row: str) -> bool:
    """Return whether all searches of a LiDAR row end where the paper mounts: roof, or corners."""
    if row in ROOF_ROWS:
        return all(map(above_roof, [*results.final_positions(row), printed_positions(row)]))
    corners = corners_of(printed_positions(row))
    return corners is not None and all(
        corners_of(positions) == corners for positions in results.final_positions(row)
    )


def height_differences(results: ReproductionResults, rows: Sequence[str]) -> list[float]:
    """Return our heights minus the paper's [m]: of every sensor, at the end of every search."""
    return [
        position[2] - printed_positions(row)[name][2]
        for row in rows
        for positions in results.final_positions(row)
        for name, position in positions.items()
    ]


def height_verdict(differences: Sequence[float]) -> str:
    """Return "about the same height", or how the heights differ on average."""
    if statistics.mean(map(abs, differences)) <= ABOUT_M:
        return "about the same height"
    mean = statistics.mean(differences)
    if abs(mean) <= APART_M:
        return "other heights"
    return f"{abs(mean):.2f} m {'higher' if mean > 0.0 else 'lower'} on average"


def distances_from_the_paper(results: ReproductionResults, rows: Sequence[str]) -> list[float]:
    """Return how far from the paper's place the farthest sensor of each search ends [m]."""
    return [
        max(math.dist(place, printed_positions(row)[name]) for name, place in positions.items())
        for row in rows
        for positions in results.final_positions(row)
    ]


def count_near_the_paper(results: ReproductionResults, row: str) -> int:
    """Return how many searches of a row end with every sensor within `MOUNT_M` of the paper's."""
    return sum(distance <= MOUNT_M for distance in distances_from_the_paper(results, [row]))


def are_apart(placements: Mapping[str, Any]) -> bool:
    """Return whether two LiDARs have different heights or different pitches."""
    first, second = placements.values()
    height = abs(first["position"][2] - second["position"][2])
    pitch = abs(first["rotation"][1] - second["rotation"][1])
    return bool(height > APART_M or pitch > APART_DEG)
