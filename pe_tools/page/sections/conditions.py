"""Conditions: the rig in each state and weather, whole and with each sensor lost."""

from __future__ import annotations

from typing import Any

from pe_core.study.condition_table import ConditionTable

from ..markup import number
from ..report_context import ReportContext

PALE, DARK = (255, 255, 255), (242, 165, 120)
"""Colours of the lowest and of the highest entropy."""


def conditions(context: ReportContext) -> dict[str, Any] | None:
    """Return the tables of a study's conditions; None for a study without."""
    found = context.outcome.conditions
    return None if found is None else table_values(found)


def table_values(found: ConditionTable) -> dict[str, Any]:
    """Return what the template shows of a table of conditions."""
    rows = found.rows
    matrix = [("Whole rig", found.mean, [row.entropy for row in rows])]
    if len(found.sensors) > 1:
        matrix += [
            (f"without {name}", found.mean_without(name), [row.without[name] for row in rows])
            for name in found.sensors
        ]
    values = [value for _, _, entropies in matrix for value in entropies]
    low, high = min(values), max(values)

    def color_of(value: float) -> str:
        share = (value - low) / (high - low) if high > low else 0.0
        rgb = (str(round(p + (d - p) * share)) for p, d in zip(PALE, DARK, strict=True))
        return f"rgb({' '.join(rgb)})"

    with_ap = all(row.ap_per_class for row in rows)
    classes = list(dict.fromkeys(name for row in rows for name in row.per_class))
    by_class = [(row.name, (row.ap_per_class or {}) if with_ap else row.per_class) for row in rows]
    return {
        "table_of": found,
        "names": [row.name for row in rows],
        "matrix": matrix,
        "highest": max(
            value
            for _, _, entropies in matrix
            for value, row in zip(entropies, rows, strict=True)
            if row.weight
        ),
        "color_of": color_of,
        "per_class": {
            "title": "Expected AP by class" if with_ap else "Entropy by class [nats]",
            "classes": classes,
            "rows": [
                [name, *(number(own[n], 3) if n in own else "" for n in classes)]
                for name, own in by_class
            ],
        },
    }
