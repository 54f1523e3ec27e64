"""What the results of the paper's experiments say: verdicts, and figures for the page.

Every ordering has a verdict that follows from the results. The discussion on the page is written
for the committed results: `statements` lists what it states, and it is left out where one of these
does not follow, as after a quick run.
"""

from __future__ import annotations

import math
import statistics
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from pe_core.metric import H_BLIND, POINTPILLARS

from ..pages import range_text
from ..results_file import Json, values_of
from .claims import SMALL_DEG, TEXTS
from .experiments import CAMERA_ROWS, FITS, LIDAR_ROWS, Effort, best_search
from .paper import (
    EXPECTED_COUNTS,
    HALF_LENGTH_M,
    HALF_WIDTH_M,
    KITTI_POSITIONS,
    PRIORS,
    ROOF_M,
    ROW,
    ROWS,
    SETTINGS,
    Position,
    study_of,
)

FIGURE_NATS = 0.1
"""Two entropies that differ by at most this are the same figure."""
ABOUT_M = 0.25
"""A sensor that is this near to a corner, or to a height, is there: a tenth of the bus's height."""
APART_M = 0.01
APART_DEG = 0.1
"""Two LiDARs that differ by more than one of these have different heights or pitches."""
AT_BOUND_M = 0.2
MAX_MOVE_M = 2.0
"""A search that ends this near to a bound ends at it; it moves a sensor so far along an axis."""
CLEAR = 2.0
"""Standard deviations from which two searches differ by more than chance."""
DENSE_DEG = 1.0 / 3.0
"""Spacing of the Pandar40's dense channels."""
CORNER_ROWS = ("3_default", "3_front")
SEARCHED_PAIRS = {
    "1": LIDAR_ROWS,
    "2": CAMERA_ROWS,
    "3 default": ("3_default", "3_default"),
    "3 front": ("3_front", "3_front"),
    "4": ("4_cameras", "3_front"),
}
"""The rows whose searches a claim compares; experiment 3: two pilots of one row, a search each."""


class Findings:
    """Complete results, as the page and the plots ask for them."""

    def __init__(self, data: Mapping[str, Any]) -> None:
        self.made: Json = data["made"]
        self.claims: Sequence[Json] = data["claims"]
        self.values = values_of(data)
        self.seconds = {name: entry["seconds"] for name, entry in data["results"].items()}
        self.effort = Effort.from_dict(self.made["effort"])

    def with_prefix(self, prefix: str) -> Json:
        """Return the values whose task name begins with a prefix, by the rest of the name."""
        return {k.removeprefix(prefix): v for k, v in self.values.items() if k.startswith(prefix)}

    def entropy(self, row: str, prior: str = PRIORS[0], kind: str = "printed") -> float:
        """Return the entropy of a row's rig at the printed placement [nats]."""
        return float(self.values[f"{kind}/{row}/{prior}"]["entropy"])

    def coverage(self, row: str, prior: str = PRIORS[0], kind: str = "printed") -> float:
        """Return the share of the prior that the rig sees there."""
        return float(self.values[f"{kind}/{row}/{prior}"]["coverage"])

    def entropy_in_view(self, row: str, prior: str = PRIORS[0]) -> float:
        """Return the mean entropy of the voxels that a row's rig sees there."""
        seen = self.coverage(row, prior)
        return (self.entropy(row, prior) - (1.0 - seen) * H_BLIND) / seen

    def best(self, row: str, prior: str = PRIORS[0]) -> Json | None:
        """Return the value of a row's best search; None where there is none."""
        value: Json | None = self.values.get(best_search(self.values, self.effort, row, prior))
        return value

    def searches(self, row: str, prior: str = PRIORS[0]) -> list[Json]:
        """Return the values of the searches of all seeds from the best start."""
        name = best_search(self.values, self.effort, row, prior)
        return list(self.with_prefix(f"{name.rpartition('/')[0]}/").values()) if name else []

    def positions(self, row: str) -> list[dict[str, Position]]:
        """Return the sensors' positions [m] at the end of the searches of all seeds."""
        ends = (search["placements"] for search in self.searches(row))
        return [{name: tuple(pose["position"]) for name, pose in end.items()} for end in ends]

    def deviation(self, row: str, prior: str = PRIORS[0]) -> float:
        """Return the standard deviation over the seeds [nats]; 0 where a row has one."""
        entropies = [search["entropy"] for search in self.searches(row, prior)]
        return statistics.stdev(entropies) if len(entropies) > 1 else 0.0

    # Orderings.

    def verdict(self, claim: Json) -> str:
        """Return "holds", "does not hold", or "not decided" where chance may have decided."""
        if claim["where"] == "searched":
            rows = SEARCHED_PAIRS[claim["experiment"]]
            chance = CLEAR * math.hypot(*(self.deviation(row, claim["prior"]) for row in rows))
            difference = claim["worse_entropy"] - claim["better_entropy"] - claim["by"]
            if abs(difference) <= chance:
                return "not decided"
        return "holds" if claim["holds"] else "does not hold"

    def claim(self, key: str, where: str = "printed", prior: str = PRIORS[0]) -> Json | None:
        """Return a claim by its key; None where there is none."""
        wanted = (key, where, prior)
        found = (c for c in self.claims if (c["experiment"], c["where"], c["prior"]) == wanted)
        return next(found, None)

    def verdicts(self, key: str, where: str = "printed") -> dict[str, str]:
        """Return the verdicts of a claim by prior."""
        claims = {prior: self.claim(key, where, prior) for prior in PRIORS}
        return {prior: self.verdict(claim) for prior, claim in claims.items() if claim}

    def under(self, verdicts: int) -> list[str]:
        """Return the orderings, but for the pitch figure, that hold under so many priors."""
        keys = [key for key in TEXTS if key != "pitch"]
        return [k for k in keys if list(self.verdicts(k).values()).count("holds") == verdicts]

    # Where searches end.

    def distances(self, row: str) -> list[float]:
        """Return how far from the paper's place the farthest sensor of each search ends [m]."""
        printed = printed_positions(row)
        return [
            max(math.dist(p, printed[n]) for n, p in end.items()) for end in self.positions(row)
        ]

    def height_differences(self) -> list[float]:
        """Return our heights minus the paper's [m], of the bus's LiDARs in all searches."""
        return [
            position[2] - printed_positions(row)[name][2]
            for row in CORNER_ROWS
            for end in self.positions(row)
            for name, position in end.items()
        ]

    def spread(self, axis: int) -> float:
        """Return how far the ends of a roof LiDAR's searches are apart along an axis [m]."""
        ends = [[end["roof"][axis] for end in self.positions(row)] for row in LIDAR_ROWS]
        return max(max(values) - min(values) for values in ends)

    def varied(self) -> dict[str, list[float]]:
        """Return the entropies of both roof LiDARs by what was changed."""
        names = {s: [f"vary/{s}/{row}" for row in LIDAR_ROWS] for s in (*SETTINGS, EXPECTED_COUNTS)}
        return {
            setting: [self.values[name]["entropy"] for name in both]
            for setting, both in names.items()
            if all(name in self.values for name in both)
        }

    def lost_orderings(self) -> list[str]:
        """Return the settings with which the ordering of experiment 1 does not hold."""
        return [name for name, (a, b) in self.varied().items() if not a < b]

    @cached_property
    def pitch_curve(self) -> list[tuple[float, float]]:
        """Pitch difference [deg] and entropy [nats] of the pitch figure."""
        return sorted((float(k), v["entropy"]) for k, v in self.with_prefix("pitch/").items())

    def pitch_peaks(self) -> list[float]:
        """Return the pitch differences at which the pitch figure has peaks [deg]."""
        curve = self.pitch_curve
        triples = zip(curve, curve[1:], curve[2:], strict=False)
        return [b[0] for a, b, c in triples if a[1] < b[1] > c[1]]

    def pitch_changes(self) -> tuple[list[float], float]:
        """Return by how much entropy changes within `SMALL_DEG`: of each alone, and of both."""
        near = [(d, h) for d, h in self.pitch_curve if abs(d) <= SMALL_DEG]
        alone = [self.values[f"pitch/{d:g}"]["alone"].values() for d, _ in near]
        both = [h for _, h in near]
        return [max(v) - min(v) for v in zip(*alone, strict=True)], max(both) - min(both)


def statements(f: Findings) -> dict[str, bool]:
    """Return what the discussion on the page states, and whether it follows from the results."""
    if not all(f.best(row.name) and len(f.searches(row.name)) > 1 for row in ROWS):
        return {"all rows are searched with several seeds": False}
    varied = f.varied()
    bounds = f.with_prefix("bound/")
    cameras = [end["camera"] for row in CAMERA_ROWS for end in f.positions(row)]
    alone, both = f.pitch_changes()
    peaks = f.pitch_peaks()
    differences = f.height_differences()
    printed = [ROW[row].entropy for row in LIDAR_ROWS]

    def off(values: Sequence[float]) -> float:
        return sum(abs(a - b) for a, b in zip(values, printed, strict=True))

    def gain(row: str) -> float:
        return f.entropy(row) - f.best(row)["entropy"]  # type: ignore[index]

    return {
        "LiDAR rows are higher than printed": all(
            f.entropy(row, prior) > ROW[row].entropy + FIGURE_NATS
            for row in (*LIDAR_ROWS, *CORNER_ROWS)
            for prior in PRIORS
        ),
        "what roof LiDARs see is below": all(
            f.entropy_in_view(row) < ROW[row].entropy for row in LIDAR_ROWS
        ),
        "KITTI's positions and expected counts are nearer": all(
            off(varied[s]) < off(varied["as shipped"]) for s in (KITTI_POSITIONS, EXPECTED_COUNTS)
        ),
        "the ordering of experiment 1 holds with all": all(a < b for a, b in varied.values()),
        "roof LiDARs end above the roof": all(
            end["roof"][2] > ROOF_M for row in LIDAR_ROWS for end in f.positions(row)
        ),
        "the Pandar64 gains, the HDL-64E nothing": gain("1_pandar64") > 0.1 > gain("1_hdl64e"),
        "seeds differ more in x and y": max(f.spread(0), f.spread(1)) > f.spread(2),
        "60 deg is lower in view, sees less": all(
            f.entropy_in_view(CAMERA_ROWS[0], p) < f.entropy_in_view(CAMERA_ROWS[1], p)
            and f.coverage(CAMERA_ROWS[0], p) < f.coverage(CAMERA_ROWS[1], p)
            for p in PRIORS
        ),
        "the formula cannot give the camera rows": all(
            value["least_all_round"] > ROW[name.split("/")[0]].entropy
            for name, value in bounds.items()
        ),
        "more would have to be in view": 1.0 - bounds["2_60deg/road"]["most_unseen"]
        > max(bounds[f"2_60deg/{p}"]["in_view"] for p in PRIORS),
        "voxels in view are higher than printed": all(
            f.entropy_in_view(row) > ROW[row].entropy + FIGURE_NATS for row in CAMERA_ROWS
        ),
        "cameras end high and far back": all(
            z >= max_height(CAMERA_ROWS[0]) - AT_BOUND_M and -x >= MAX_MOVE_M - AT_BOUND_M
            for x, _, z in cameras
        ),
        "the bus's LiDARs end at the paper's corners": all(
            corners_of(end) == corners_of(printed_positions(row)) is not None
            for row in CORNER_ROWS
            for end in f.positions(row)
        ),
        "at about the same height": statistics.mean(map(abs, differences)) <= ABOUT_M,
        "and differ in height or pitch": all(
            are_apart(search["placements"]) for row in CORNER_ROWS for search in f.searches(row)
        ),
        "cameras gain more than the paper's": f.entropy("4_cameras", kind="lidars")
        - f.entropy("4_cameras")
        > ROW["3_front"].entropy - ROW["4_cameras"].entropy,
        "equal pitch is the worst": max((h, d) for d, h in f.pitch_curve if abs(d) <= SMALL_DEG)[1]
        == 0.0,
        "peaks are a dense channel apart": abs(
            (peaks[-1] - peaks[0]) / (len(peaks) - 1) - DENSE_DEG
        )
        <= f.effort.pitch_step_deg / 2.0,
        "each LiDAR alone changes less": max(alone) < both,
        "cars have a steeper slope than the paper's, the others agree": [
            (fit := f.values[f"fit/kitti_{name}"])["a"] - POINTPILLARS.a > fit["a_error"]
            for name in ("car", "pedestrian", "cyclist")
        ]
        == [True, False, False],
        "the fit gives the paper's curve back": abs(
            f.values["fit/paper_lidar"]["a"] - POINTPILLARS.a
        )
        <= 1e-6,
    }


def printed_positions(row: str) -> dict[str, Position]:
    """Return the sensors' positions that the paper prints for a row [m]."""
    return {s.name: s.pose.position for s in study_of(row).rig}


def max_height(row: str) -> float:
    """Return the greatest height that a search allows a row's sensors [m]."""
    return max(axes["z"][1] for axes in study_of(row).search_space().bounds.values())


def corners_of(positions: Mapping[str, Position]) -> list[tuple[int, int]] | None:
    """Return the bus's corners with a sensor, by the signs of x and y; None if one is at none.

    A pair of corners and its mirror image give the same result: the one with the first on the left.
    """
    for x, y, _ in positions.values():
        if max(abs(abs(x) - HALF_LENGTH_M), abs(abs(y) - HALF_WIDTH_M)) > ABOUT_M:
            return None
    corners = sorted((1 if x > 0.0 else -1, 1 if y > 0.0 else -1) for x, y, _ in positions.values())
    return max(corners, sorted((x, -y) for x, y in corners))


def are_apart(placements: Mapping[str, Any]) -> bool:
    """Return whether two LiDARs have different heights or different pitches."""
    first, second = placements.values()
    height = abs(first["position"][2] - second["position"][2])
    return bool(height > APART_M or abs(first["rotation"][1] - second["rotation"][1]) > APART_DEG)


def page_values(f: Findings) -> Json:
    """Return what the template of the page is given."""
    stated = statements(f)
    seconds = [s for name, s in f.seconds.items() if name.startswith("search/")]
    return {
        "f": f,
        "stated": all(stated.values()),
        "row": ROW,
        "priors": PRIORS,
        "texts": TEXTS,
        "blind": H_BLIND,
        "same_figure": sum(abs(f.entropy(r.name) - r.entropy) <= FIGURE_NATS for r in ROWS),
        "figure_nats": FIGURE_NATS,
        "clear": CLEAR,
        "max_height": max_height(CAMERA_ROWS[0]),
        "pictures": [(ROW[row.name].label, row.name) for row in ROWS],
        "search_minutes": range_text([max(s, 1e-3) / 60 for s in seconds], 1),
        "camera_rows": CAMERA_ROWS,
        "fits": FITS,
        "minutes": sum(f.seconds.values()) / 60,
        "tasks": (len(seconds), len(f.seconds) - len(seconds)),
    }
