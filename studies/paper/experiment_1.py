"""Experiment 1, two LiDARs above a car's roof, and the settings that it depends on."""

from __future__ import annotations

import statistics
from collections.abc import Mapping
from typing import Any

from pe_core.metric import H_BLIND

from ..wording import compared_with_printed, gain_text, how_many, joined, range_text, table
from .paper import (
    DEFAULT_SETTING,
    EXPECTED_COUNTS,
    KITTI_POSITIONS,
    PRIORS,
    ROOF_M,
    ROW,
    SETTING_GROUPS,
    SETTINGS,
)
from .plan import LIDAR_ROWS
from .result_view import ReproductionResults, above_roof, printed_positions
from .tables import ordering_verdict, placements

PRINTED = [ROW[row].entropy for row in LIDAR_ROWS]
NOTES = {
    "the side of the voxels": "A larger cube meets more beams, and AP = a ln m + b was fitted for a "
    "voxel of 0.1 m, so only that side is meaningful; the others show the size of the effect.",
    "the prior's scales": "Without the paper's prior, its absolute figures cannot be checked.",
    "the vehicle": '"No vehicle" also counts the voxels where the vehicle would be, which a LiDAR on '
    "its roof does not see.",
}


def experiment_1(results: ReproductionResults) -> str:
    """Return the section on the two roof LiDARs."""
    low, high = (results.entropy(row) for row in LIDAR_ROWS)
    return f"""
## Experiment 1: Pandar64 and HDL-64E

**Ordering: {ordering_verdict(results, "1")}** Paper: {PRINTED[0]} and {PRINTED[1]}; ours: {low:.4f} and {high:.4f}
under `road`.

**Figures: {_figures(results, low, high)}** {_unseen(results)} {_nearer(results)}

{_placement(results)}

{placements(results, list(LIDAR_ROWS))}
"""


def _figures(results: ReproductionResults, low: float, high: float) -> str:
    ours, theirs = abs(high - low), abs(PRINTED[1] - PRINTED[0])
    gap = "with a larger difference" if ours > theirs else "with a smaller difference"
    return results.verdict("1: figures", f"{compared_with_printed([low, high], PRINTED)}, {gap}.")


def _unseen(results: ReproductionResults) -> str:
    unseen = [1.0 - results[f"printed/{row}/road"]["coverage"] for row in LIDAR_ROWS]
    seen = [results.entropy_in_view(row, PRIORS[0]) for row in LIDAR_ROWS]
    below = sum(mean < printed for mean, printed in zip(seen, PRINTED, strict=True))
    verdict = results.verdict("1: in view", f"{how_many(below, 2)} below the printed figures")
    return (
        "m counts whole beams, and between the channels there are voxels without a beam: the Pandar64 does not "
        f"see {unseen[0]:.1%} of the prior and the HDL-64E {unseen[1]:.1%}, which alone costs "
        f"{unseen[0] * H_BLIND:.2f} and {unseen[1] * H_BLIND:.2f} nats. The mean over the voxels that they see "
        f"is {seen[0]:.2f} and {seen[1]:.2f}, {verdict}."
    )


def _nearer(results: ReproductionResults) -> str:
    """Return whether another prior, or another way to count, gives figures nearer to the printed."""
    phrases = []
    for setting in (KITTI_POSITIONS, EXPECTED_COUNTS):
        names = [f"vary/{setting}/{row}" for row in LIDAR_ROWS]
        if not all(name in results.values for name in names):
            return ""
        low, high = (results[name]["entropy"] for name in names)
        phrases.append(f"{low:.4f} and {high:.4f}, {_nearness(results, setting, [low, high])}")
    return (
        "With a prior whose positions are fitted to KITTI's labels instead of nuScenes', the figures are "
        f"{phrases[0]}. With beams that are spread evenly between the channels, so that every voxel has "
        f"its expected number of beams, and without the vehicle, they are {phrases[1]}. The paper describes "
        "whole beams, and so we count whole beams."
    )


def _nearness(results: ReproductionResults, setting: str, varied: list[float]) -> str:
    """Return whether figures with a setting are nearer to the printed ones than the default ones."""
    default = [results.entropy(row) for row in LIDAR_ROWS]
    before, after = (
        statistics.mean(abs(a - b) for a, b in zip(values, PRINTED, strict=True))
        for values in (default, varied)
    )
    word = "nearer to" if after < before else "no nearer to"
    text = (
        f"{word} the printed ones (a mean difference of {after:.2f} nats instead of {before:.2f})"
    )
    return results.verdict(f"1: {setting}", text)


def _placement(results: ReproductionResults) -> str:
    """Return where the searches of the roof LiDARs end, compared with the paper."""
    if not results.was_searched(LIDAR_ROWS[0]):
        return ""
    ends = [positions for row in LIDAR_ROWS for positions in results.final_positions(row)]
    above = sum(map(above_roof, ends))
    theirs = joined([f"{printed_positions(row)['roof'][2]:.2f}" for row in LIDAR_ROWS])
    printed_above = all(above_roof(printed_positions(row)) for row in LIDAR_ROWS)
    as_paper = "as" if above == len(ends) and printed_above else "not as"
    verdict = results.verdict(
        "1: above the roof", f"{how_many(above, len(ends))} above the roof, {as_paper}"
    )
    return (
        f"**Placement: {verdict} in the paper.** The searches end with {joined([_end(results, r) for r in LIDAR_ROWS])}. "
        f"The paper's heights are {theirs} m on a car that it does not describe; our roof is at {ROOF_M} m. "
        f"{_largest_spread(results)} Height and pitch determine which layers of voxels the dense channels cross."
    )


def _end(results: ReproductionResults, row: str) -> str:
    heights = [positions["roof"][2] for positions in results.final_positions(row)]
    gain = results.verdict(
        f"1: gain of {row}", gain_text(results.entropy(row) - results.best(row)["entropy"])
    )
    return f"the {ROW[row].label} at {range_text(heights)} m ({gain})"


def _largest_spread(results: ReproductionResults) -> str:
    """Return whether the ends of the searches differ more in x and y than in height."""
    if any(len(results.final_positions(row)) < 2 for row in LIDAR_ROWS):
        return ""
    x, y, height = (max(_spread(results, row, axis) for row in LIDAR_ROWS) for axis in range(3))
    word = results.verdict("1: loosest", "more" if max(x, y) > height else "no more")
    return (
        f"The seeds differ {word} in x and y, by up to {max(x, y):.2f} m, than in height, by up to "
        f"{height:.2f} m."
    )


def _spread(results: ReproductionResults, row: str, axis: int) -> float:
    coordinates = [positions["roof"][axis] for positions in results.final_positions(row)]
    return max(coordinates) - min(coordinates)


def sensitivity(results: ReproductionResults) -> str:
    """Return the section on the settings that experiment 1 depends on."""
    varied = results.with_prefix("vary/")
    settings = [s for s in (*SETTINGS, EXPECTED_COUNTS) if f"{s}/{LIDAR_ROWS[0]}" in varied]
    titles = ["setting", *(ROW[row].label for row in LIDAR_ROWS), "difference", "ordering"]
    return f"""
## What experiment 1 depends on

One setting changed at a time, at the printed placements, under `road`. {_ordering(results, varied, settings)}

{table(titles, [_setting_line(varied, setting) for setting in settings])}

![Both LiDARs under each change](sensitivity.png)

{_ranking(results, varied)}
"""


def _pair(varied: Mapping[str, Any], setting: str) -> list[float]:
    return [varied[f"{setting}/{row}"]["entropy"] for row in LIDAR_ROWS]


def _setting_line(varied: Mapping[str, Any], setting: str) -> list[str]:
    low, high = _pair(varied, setting)
    verdict = "holds" if low < high else "**does not hold**"
    return [setting, f"{low:.4f}", f"{high:.4f}", f"{high - low:.2f}", verdict]


def _ordering(results: ReproductionResults, varied: Mapping[str, Any], settings: list[str]) -> str:
    lost = [s for s in settings if not _pair(varied, s)[0] < _pair(varied, s)[1]]
    if not lost:
        text = "The ordering holds with all of them."
    else:
        text = f"The ordering does not hold with {len(lost)} of {len(settings)}: {joined(lost)}."
    return results.verdict("sensitivity: ordering", text)


def _ranking(results: ReproductionResults, varied: Mapping[str, Any]) -> str:
    """Return the groups of settings by their largest effect on one of the two LiDARs."""
    changes = {}
    for group, settings in SETTING_GROUPS.items():
        effects = [
            abs(entropy - default)
            for setting in settings
            if f"{setting}/{LIDAR_ROWS[0]}" in varied
            for entropy, default in zip(
                _pair(varied, setting), _pair(varied, DEFAULT_SETTING), strict=True
            )
        ]
        if effects:
            changes[group] = max(effects)
    ranked = sorted(changes, key=lambda group: -changes[group])
    listed = joined([f"{group} ({changes[group]:.2f} nats)" for group in ranked])
    notes = " ".join(NOTES[group] for group in ranked if group in NOTES)
    text = f"The settings by their largest effect on one of the two LiDARs: {listed}."
    return f"{results.verdict('sensitivity: order', text)} {notes}"
