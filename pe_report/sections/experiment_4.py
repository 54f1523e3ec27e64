"""Experiment 4: two LiDARs and two cameras on a bus."""

from __future__ import annotations

from pe_core.metric import H_BLIND

from ..facts import Facts
from ..paper import ROW
from ..words import GAIN_NATS
from .tables import placements, same


def experiment_4(facts: Facts) -> str:
    """Return the account of LiDARs with cameras."""
    return f"""
## Experiment 4: two LiDARs and two cameras

**Ordering: {same(facts, "4")}** {_gain(facts)} {_coverage(facts)}

The paper gives no yaw; its rear camera is taken to look back, the front one ahead.

{placements(facts, ["4_cameras"])}
"""


def _gain(facts: Facts) -> str:
    """Return what the cameras gain, beside the paper's gain."""
    with_cameras, alone = facts.entropy("4_cameras"), facts.entropy("4_cameras", kind="lidars")
    theirs, ours = ROW["3_front"].entropy - ROW["4_cameras"].entropy, alone - with_cameras
    verb = "gain" if ours > 0.0 else "lose"
    if abs(ours - theirs) <= GAIN_NATS:
        word = "as much as"
    else:
        word = "more than" if ours > theirs else "less than"
    told = facts.say("4: gain", f"Ours {verb} {abs(ours):.2f}, {word} the paper's")
    return (
        f"The paper gains {theirs:.2f} nats by the cameras (against its own experiment 3, front doubled). "
        f"{told}, at the same LiDAR placement: {alone:.4f} without, {with_cameras:.4f} with, under `road`."
    )


def _coverage(facts: Facts) -> str:
    before, after = (facts[f"{kind}/4_cameras/road"]["coverage"] for kind in ("lidars", "printed"))
    verb = facts.say("4: coverage", "rises" if after > before else "does not rise")
    told = f"Coverage {verb}: {before:.1%} without, {after:.1%} with"
    if after <= before:
        return f"{told}."
    worth = (after - before) * H_BLIND
    return (
        f"{told}. What the cameras alone see cost {worth:.2f} nats before, at {H_BLIND:.2f} for a voxel "
        "that nothing sees."
    )
