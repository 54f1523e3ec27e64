"""What experiment 1 depends on, one thing changed at a time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..facts import Facts
from ..paper import ROW
from ..plan import LIDAR_ROWS
from ..settings import EXPECTED, GROUPS, SETTINGS, SHIPPED
from ..words import joined, table

NOTES = {
    "the side of the voxels": "A larger cube meets more beams, and AP = a ln m + b was fitted for a "
    "voxel of 0.1 m, so only that one has a meaning; the others tell how steep the dependence is.",
    "the prior's scales": "The paper's absolute figures cannot be judged without its prior.",
    "the vehicle": '"No vehicle" also counts the voxels where the vehicle would be, which a LiDAR on '
    "its roof does not see.",
}


def sensitivity(facts: Facts) -> str:
    """Return what experiment 1 depends on."""
    varied = facts.named("vary/")
    settings = [s for s in (*SETTINGS, EXPECTED) if f"{s}/{LIDAR_ROWS[0]}" in varied]
    titles = ["changed", ROW[LIDAR_ROWS[0]].label, ROW[LIDAR_ROWS[1]].label, "apart", "ordering"]
    return f"""
## What experiment 1 depends on

One thing changed at a time, at the printed placements, under `road`. {_always(facts, varied, settings)}

{table(titles, [_line(varied, setting) for setting in settings])}

![Both LiDARs under each change](sensitivity.png)

{_largest(facts, varied)}
"""


def _pair(varied: Mapping[str, Any], setting: str) -> list[float]:
    return [varied[f"{setting}/{row}"]["entropy"] for row in LIDAR_ROWS]


def _line(varied: Mapping[str, Any], setting: str) -> list[str]:
    low, high = _pair(varied, setting)
    verdict = "holds" if low < high else "**does not hold**"
    return [setting, f"{low:.4f}", f"{high:.4f}", f"{high - low:.2f}", verdict]


def _always(facts: Facts, varied: Mapping[str, Any], settings: list[str]) -> str:
    lost = [s for s in settings if not _pair(varied, s)[0] < _pair(varied, s)[1]]
    if not lost:
        told = "The ordering holds in all of them."
    else:
        told = f"The ordering does not hold with {len(lost)} of {len(settings)}: {joined(lost)}."
    return facts.say("sensitivity: ordering", told)


def _largest(facts: Facts, varied: Mapping[str, Any]) -> str:
    """Say what matters most, and how much: the largest change of either LiDAR in each group."""
    changes = {}
    for group, settings in GROUPS.items():
        found = [
            abs(ours - shipped)
            for setting in settings
            if f"{setting}/{LIDAR_ROWS[0]}" in varied
            for ours, shipped in zip(_pair(varied, setting), _pair(varied, SHIPPED), strict=True)
        ]
        if found:
            changes[group] = max(found)
    ranked = sorted(changes, key=lambda group: -changes[group])
    told = joined([f"{group} ({changes[group]:.2f} nats)" for group in ranked])
    notes = " ".join(NOTES[group] for group in ranked if group in NOTES)
    return f"{facts.say('sensitivity: order', f'By its largest effect on either LiDAR: {told}.')} {notes}"
