"""What was published, and how thin it is."""

from __future__ import annotations

from ...words import table
from ..facts import ValidityFacts, least_told_apart
from ..published import Paper, papers


def evidence(facts: ValidityFacts) -> str:
    """Return what was published, and how thin it is."""
    return f"""
## The evidence

{table(["paper", "placements", "LiDARs", "classes", "detectors", "conditions"], [_row(p) for p in papers()])}

{"".join(_notes(paper) for paper in papers())}
Both are simulations in CARLA with four LiDARs of 16 channels, by overlapping authors. The unit is the
placement: four detectors trained on the same eight placements are eight placements looked at four
times. Shuffled over {len(papers()[0].placements)} placements, a rank correlation (Spearman's rho) has to
reach {least_told_apart(8):.2f} before chance would do it in less than 5 % of all orders; over 4, the distinct LiDAR
layouts of the second paper, no rho can.

![Mean height of the LiDARs against AP of cars, in both papers](height.png)

*AP of cars, mean over the detectors after each is scaled to its own best and worst placement, against
the mean height of the LiDARs. Level placements filled, rolled ones hollow.*
"""


def _row(paper: Paper) -> list[str]:
    of, detectors = paper.lidar, list(next(iter(paper.ap.values())))
    lidars = f"{of['channels']:.0f} channels, {of['low_deg']:g} to {of['high_deg']:g} deg"
    return [
        f"{paper.citation} ({paper.repository})",
        str(len(paper.placements)),
        lidars,
        ", ".join(paper.classes.values()),
        ", ".join(detectors),
        ", ".join(paper.ap).replace("_", " "),
    ]


def _notes(paper: Paper) -> str:
    read = f"- {paper.short}, read from: {paper.read}.\n"
    return read + "".join(f"- {paper.short}: {note}\n" for note in paper.notes)
