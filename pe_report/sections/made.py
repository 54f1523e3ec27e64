"""How the results were made: commit, machine, seeds, cost."""

from __future__ import annotations

from ..facts import Facts
from ..paper import HOUR_S


def how_made(facts: Facts) -> str:
    """Return commit, machine, seeds and cost."""
    made, effort = facts.made, facts.effort
    searches = facts.search_seconds()
    longest = max(searches)
    total = sum(facts.seconds.values())
    scored = (
        "the whole grid of 64 million voxels"
        if not effort.samples
        else (f"{effort.samples:,} voxels drawn from the prior")
    )
    seeds = ", ".join(str(s) for s in effort.seeds)
    return f"""
## How it was made

| | |
| --- | --- |
| commit | {made["commit"]} |
| machine | {made["machine"]} |
| versions | perception-entropy {made["version"]}, Python {made["python"]}, NumPy {made["numpy"]} |
| scores | on {scored} |
| searches | Algorithm 1: seven rounds of {effort.candidates} candidates, each judged on {effort.search_samples:,} voxels |
| seeds | {seeds} |
| cost | {len(searches)} searches and {len(facts.seconds) - len(searches)} other tasks, {total / 60:.0f} minutes of one processor |
| one search | {min(searches) / 60:.1f} to {longest / 60:.1f} minutes on one processor; the paper's takes "around an hour" ({HOUR_S / longest:.0f} to {HOUR_S / min(searches):.0f} times as long) |

Again: `pe reproduce` (or `pe reproduce --quick`, in a minute, for the orderings alone). `pe reproduce
--check` computes again what needs no search, and compares it with results.json digit by digit.
"""
