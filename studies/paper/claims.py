"""The paper's claims, orderings of two rigs, each compared with our scores."""

from __future__ import annotations

from collections.abc import Iterator
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


TEXTS = {
    "1": "Pandar64 is better than HDL-64E",
    "2": "60 deg is better than 120 deg, the weight beyond 40 m doubled",
    "3 default": "LiDARs at diagonal corners beat both at the front",
    "3 front": "both at the front beat diagonal corners when the front counts double",
    "4": f"two cameras improve two LiDARs strongly (by {STRONG_NATS} and more)",
    "pitch": "a small pitch difference is better than none",
}


def claims(values: Values, effort: Effort) -> list[Claim]:
    """Return all claims: at the printed placements under every prior, and of our own searches."""
    printed = [claim for prior in PRIORS for claim in _printed(values, prior)]
    return [*printed, *_searched(values, effort), _pitch(values, effort)]


def _printed(values: Values, prior: str) -> Iterator[Claim]:
    def entropy(name: str) -> float:
        return values[f"{name}/{prior}"]["entropy"]

    pairs = (
        ("1", "Pandar64", "printed/1_pandar64", "HDL-64E", "printed/1_hdl64e", 0.0),
        ("2", "60 deg", "printed/2_60deg", "120 deg", "printed/2_120deg", 0.0),
        ("3 default", "diagonal", "printed/3_default", "front", "swapped/3_default", 0.0),
        ("3 front", "front", "printed/3_front", "diagonal", "swapped/3_front", 0.0),
        ("4", "all", "printed/4_cameras", "LiDARs alone", "lidars/4_cameras", STRONG_NATS),
    )
    for key, better, low, worse, high, by in pairs:
        figures = entropy(low), worse, entropy(high), by
        yield Claim(key, TEXTS[key], "printed", prior, better, *figures)


def _searched(values: Values, effort: Effort) -> Iterator[Claim]:
    """Yield the claims on our own searches, of the rows that were searched."""
    for key, better, worse in (("1", "1_pandar64", "1_hdl64e"), ("2", "2_60deg", "2_120deg")):
        for prior in PRIORS:
            names = [best_search(values, effort, row, prior) for row in (better, worse)]
            if all(names):
                low, high = (values[name]["entropy"] for name in names)
                yield _searched_claim(key, prior, ROW[better].label, low, ROW[worse].label, high)
    for key, row, better, worse in (
        ("3 default", "3_default", "diagonal", "front"),
        ("3 front", "3_front", "front", "diagonal"),
    ):
        names = [pilot_name(row, PRIORS[0], start) for start in (better, worse)]
        if all(name in values for name in names):
            low, high = (values[name]["entropy"] for name in names)
            yield _searched_claim(key, PRIORS[0], better, low, worse, high)
    names = [best_search(values, effort, row, PRIORS[0]) for row in ("4_cameras", "3_front")]
    if all(names):
        low, high = (values[name]["entropy"] for name in names)
        yield _searched_claim("4", PRIORS[0], "with cameras", low, "two LiDARs", high, STRONG_NATS)


def _searched_claim(
    key: str, prior: str, better: str, low: float, worse: str, high: float, by: float = 0.0
) -> Claim:
    return Claim(key, TEXTS[key], "searched", prior, better, low, worse, high, by)


def _pitch(values: Values, effort: Effort) -> Claim:
    curve = {d: values[f"pitch/{d:g}"]["entropy"] for d in pitch_differences(effort)}
    small = {d: h for d, h in curve.items() if 0.0 < abs(d) <= SMALL_DEG}
    best = min(small, key=lambda d: small[d])
    figures = f"{best:g} deg", small[best], "0 deg", curve[0.0]
    return Claim("pitch", TEXTS["pitch"], "printed", PRIORS[0], *figures)
