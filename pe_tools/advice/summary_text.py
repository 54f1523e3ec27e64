"""Describe a score in sentences: hidden sensors, coverage, zones."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from pe_core.scene.rig import Rig
from pe_core.scoring.score import FAR_M, NEAR_M, PartScore, Score
from pe_tools.wording import percent

from .advice import Advice
from .summary import Outlook, object_words, objects_looked_at, outlook_words
from .warnings import hidden_sensors, hidden_words

WHERE = {
    "front": "ahead",
    "rear": "behind",
    "left": "on the left",
    "right": "on the right",
    "near": f"within {NEAR_M:g} m",
    "mid": f"from {NEAR_M:g} to {FAR_M:g} m",
    "far": f"beyond {FAR_M:g} m",
}
"""Text for each zone of `scoring.zones.ZONES`."""


def rig_words(
    score: Score,
    seen: Outlook | None = None,
    rig: Rig | None = None,
    warnings: Sequence[Advice] = (),
) -> tuple[str, ...]:
    """Describe a score in short lines: hidden sensors, coverage, zones.

    `seen` is the outlook of the same rig: it adds the coverage by several sensors, expected AP,
    reach and blind ground. Of `rig`, sensors that see nothing are named; `warnings` explain why.
    """
    hidden = () if rig is None else hidden_words(hidden_sensors(rig, score, warnings))
    lines = [*hidden, _coverage(score, seen), *_zones(score.per_zone)]
    if score.objects is not None:
        lines += object_words(score.objects)
    if seen is not None:
        lines += outlook_words(seen, of_voxels=score.objects is None)
    return tuple(lines)


def _coverage(score: Score, seen: Outlook | None) -> str:
    if score.objects is not None:
        looked_at = objects_looked_at(score.objects)
        return f"{percent(score.coverage)} of the objects are seen, by weight ({looked_at})"
    line = f"{percent(score.coverage)} of where objects are is seen"
    if seen is None or len(seen.shares.by_number) < 3:
        return line
    return f"{line}; {percent(seen.shares.by_number[2])} by two or more sensors"


def _zones(zones: Mapping[str, PartScore]) -> Iterator[str]:
    """Name the zones with the lowest and the highest entropy."""
    order = sorted(zones, key=lambda name: zones[name].entropy)
    if order and zones[order[0]].entropy < zones[order[-1]].entropy:
        best, worst = (
            f"{WHERE.get(name, name)} ({zones[name].entropy:.2f} nats, "
            f"{percent(zones[name].coverage)} seen)"
            for name in (order[0], order[-1])
        )
        yield f"best {best}, worst {worst}"
