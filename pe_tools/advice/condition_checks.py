"""Warnings about conditions: parts driven into the ground, sensors that a moved part covers."""

from __future__ import annotations

from pe_core.study.condition_table import ConditionTable

from .advice import Advice


def condition_warnings(table: ConditionTable | None) -> tuple[Advice, ...]:
    """Return the warnings about a table of conditions; none without a table."""
    if table is None:
        return ()
    found = []
    for state, depths in table.below_ground.items():
        part, depth = next(iter(depths.items()))
        more = f" and {len(depths) - 1} more parts" if len(depths) > 1 else ""
        text = f"state {state!r} drives {part!r}{more} through the ground, {depth:.2f} m deep"
        found.append(Advice(None, "below_ground", text, part))
    told = set()
    for row in table.rows:
        for sensor, parts in (row.covered or {}).items():
            part, share = max(parts.items(), key=lambda each: each[1])
            if (key := (row.state, sensor)) not in told:
                told.add(key)
                text = f"in state {row.state!r}, {part!r} covers {share:.0%} of what it sees"
                found.append(Advice(sensor, "covered", f"{text}, beyond that as drawn", part))
    return tuple(found)
