"""The paper's claims, orderings of two rigs, each compared with our scores."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from ..results_file import Values
from .experiments import Effort, best_search, pilot_name, pitch_differences
from .paper import PRIORS, ROW

STRONG_NATS = 0.39
"""A smaller improvement is not strong: half of what two cameras gain in the paper
(1.6864 - 0.8965)."""
SMALL_DEG = 1.0
"""Pitch differences up to this one are small."""
TEXTS = {
    "1": "Pandar64 is better than HDL-64E",
    "2": "60 deg is better than 120 deg, the weight beyond 40 m doubled",
    "3 default": "LiDARs at diagonal corners beat both at the front",
    "3 front": "both at the front beat diagonal corners when the front counts double",
    "4": f"two cameras improve two LiDARs strongly (by {STRONG_NATS} and more)",
    "pitch": "a small pitch difference is better than none",
}
PRINTED = (
    ("1", "Pandar64", "printed/1_pandar64", "HDL-64E", "printed/1_hdl64e", 0.0),
    ("2", "60 deg", "printed/2_60deg", "120 deg", "printed/2_120deg", 0.0),
    ("3 default", "diagonal", "printed/3_default", "front", "swapped/3_default", 0.0),
    ("3 front", "front", "printed/3_front", "diagonal", "swapped/3_front", 0.0),
    ("4", "all", "printed/4_cameras", "LiDARs alone", "lidars/4_cameras", STRONG_NATS),
)
"""Claims at printed placements: the better and the worse rig with the names of their tasks."""


@dataclass(frozen=True)
class Claim:
    """The claim, a key of `TEXTS`, that one rig scores lower than another, with our scores [nats].

    `where` is "printed" for the paper's placements, "searched" for ours. The better rig, which the
    paper finds better, has to be lower by `by`.
    """

    experiment: str
    text: str
    where: str
    prior: str
    better: str
    better_entropy: float
    worse: str
    worse_entropy: float
    by: float = 0.0

    @property
    def holds(self) -> bool:
        """Whether our scores agree with the claim."""
        return self.worse_entropy - self.better_entropy > self.by

    def to_dict(self) -> dict[str, Any]:
        """Return the claim, and whether it holds, as plain JSON data."""
        return {**asdict(self), "holds": self.holds}


def claims(values: Values, effort: Effort) -> list[Claim]:
    """Return all claims: at the printed placements under every prior, and of our own searches."""
    found = list[Claim]()
    road = PRIORS[0]

    def add(
        key: str, where: str, prior: str, rigs: tuple[str, str], names: tuple[str, str], by: float
    ) -> None:
        if all(name in values for name in names):  # searches may be missing
            low, high = (values[name]["entropy"] for name in names)
            found.append(
                Claim(
                    experiment=key,
                    text=TEXTS[key],
                    where=where,
                    prior=prior,
                    better=rigs[0],
                    better_entropy=low,
                    worse=rigs[1],
                    worse_entropy=high,
                    by=by,
                )
            )

    def best(*rows: str, prior: str = road) -> tuple[str, str]:
        first, second = (best_search(values, effort, row, prior) for row in rows)
        return first, second

    for prior in PRIORS:
        for key, better, low, worse, high, by in PRINTED:
            names = f"{low}/{prior}", f"{high}/{prior}"
            add(key, "printed", prior, (better, worse), names=names, by=by)
    for key, rows in (("1", ("1_pandar64", "1_hdl64e")), ("2", ("2_60deg", "2_120deg"))):
        for prior in PRIORS:
            labels = ROW[rows[0]].label, ROW[rows[1]].label
            add(key, "searched", prior, labels, names=best(*rows, prior=prior), by=0.0)
    for key, row, starts in (
        ("3 default", "3_default", ("diagonal", "front")),
        ("3 front", "3_front", ("front", "diagonal")),
    ):
        names = pilot_name(row, road, starts[0]), pilot_name(row, road, starts[1])
        add(key, "searched", road, starts, names=names, by=0.0)
    rigs = "with cameras", "two LiDARs"
    add("4", "searched", road, rigs, names=best("4_cameras", "3_front"), by=STRONG_NATS)
    small = [d for d in pitch_differences(effort) if 0.0 < abs(d) <= SMALL_DEG]
    least = min(small, key=lambda d: values[f"pitch/{d:g}"]["entropy"])
    names = f"pitch/{least:g}", "pitch/0"
    add("pitch", "printed", road, (f"{least:g} deg", "0 deg"), names=names, by=0.0)
    return found
