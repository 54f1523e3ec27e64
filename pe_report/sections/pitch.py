"""The pitch figure: two equal LiDARs, one pitched a little."""

from __future__ import annotations

from ..claims import SMALL_DEG
from ..facts import Facts
from ..paper import PITCH_HEIGHT_M
from ..words import joined

Points = list[tuple[float, float]]

DENSE_DEG = 1.0 / 3.0
"""Spacing of the Pandar40's dense channels."""


def pitch(facts: Facts) -> str:
    """Return the account of the pitch figure."""
    curve = sorted((float(k), v["entropy"]) for k, v in facts.named("pitch/").items())
    lowest = min(curve, key=lambda pair: pair[1])
    return f"""
## The pitch figure

Two Pandar40 at the bus's front corners, both {PITCH_HEIGHT_M} m high, the first level, under `road` with
default weights. {_verdict(facts)} {_worst(facts, curve)} The lowest of the whole range is
{lowest[1]:.4f} at {lowest[0]:g} deg. {_period(facts, curve)} {_alone(facts, curve)}

![Entropy against the pitch difference](pitch.png)
"""


def _verdict(facts: Facts) -> str:
    """Say whether a small difference is better than none."""
    claim = facts.claim("pitch", "printed")
    level, small = (
        f"{claim['worse_entropy']:.4f}",
        f"{claim['better_entropy']:.4f} at {claim['better']}",
    )
    if claim["holds"]:
        told = (
            f"**The same as in the paper:** at equal pitch the channels of one cover those of the other "
            f"({level}); a small difference puts the beams of one into the gaps of the other ({small})."
        )
    else:
        told = f"**Not as in the paper:** no small difference improves on equal pitch ({level}; {small})."
    return facts.say("pitch", told)


def _worst(facts: Facts, curve: Points) -> str:
    near = [(d, h) for d, h in curve if abs(d) <= SMALL_DEG]
    worst = max(near, key=lambda pair: pair[1])
    word = "Equal pitch is" if worst[0] == 0.0 else f"Not equal pitch but {worst[0]:g} deg is"
    told = facts.say("pitch: worst", f"{word} the worst within {SMALL_DEG:g} deg")
    return f"{told} ({worst[1]:.4f})."


def _period(facts: Facts, curve: Points) -> str:
    """Say whether the peaks of the curve are as far apart as the dense channels are."""
    triples = zip(curve, curve[1:], curve[2:], strict=False)
    peaks = [b[0] for a, b, c in triples if a[1] < b[1] > c[1]]
    step = curve[1][0] - curve[0][0]
    if len(peaks) < 3 or step > DENSE_DEG / 2.0:
        return ""
    apart = (peaks[-1] - peaks[0]) / (len(peaks) - 1)
    same = "the spacing" if abs(apart - DENSE_DEG) <= step / 2.0 else "not the spacing"
    told = facts.say("pitch: period", f"{apart:.2f} deg apart on average, {same}")
    return (
        f"Its {len(peaks)} peaks are {told} of the Pandar40's dense channels ({DENSE_DEG:.2f} deg)."
    )


def _alone(facts: Facts, curve: Points) -> str:
    """Say how much less each LiDAR alone changes than both together."""
    near = [d for d, _ in curve if abs(d) <= SMALL_DEG]
    alone = [facts[f"pitch/{d:g}"]["alone"] for d in near]
    changes = [max(v) - min(v) for v in zip(*(a.values() for a in alone), strict=True)]
    fused = [h for d, h in curve if d in near]
    together = max(fused) - min(fused)
    word = facts.say("pitch: alone", "less" if max(changes) < together else "no less")
    return (
        f"Each LiDAR alone changes {word} over {SMALL_DEG:g} deg to each side, by "
        f"{joined([f'{c:.2f}' for c in changes])} nats, than both together, by {together:.2f}."
    )
