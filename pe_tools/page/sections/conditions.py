"""Conditions: the rig in each state and weather, whole and with each sensor lost."""

from __future__ import annotations

from pe_core.study.condition_table import ConditionTable

from ..markup import Markup, escaped, number, percent, table
from ..report_context import ReportContext, Section

CSS = """
.heat { display: block; padding: .1rem .4rem; border-radius: 3px; text-align: right;
  font-variant-numeric: tabular-nums; }
.heat.worst { outline: 2px solid #c4320a; }
"""
NOTE = (
    "Entropy in nats; lower is better. Columns are states of the vehicle in weathers, rows the "
    "whole rig and the rig without one sensor. The darker a cell, the higher its entropy; the "
    "outlined cell is the worst of all with a weight. The mean is that by weights."
)
PALE, DARK = (255, 255, 255), (242, 165, 120)


def conditions(context: ReportContext) -> Section:
    """Return the table of a study's conditions; empty for a study without."""
    found = context.outcome.conditions
    html = "" if found is None else content(found)
    return Section("conditions", "Conditions", html, styles=(CSS,))


def content(found: ConditionTable) -> str:
    """Return the tables of conditions as HTML."""
    worst = found.worst
    brief = (
        f"Mean of {len(found.rows)} conditions {number(found.mean, 4)} nats, worst "
        f"{number(worst.entropy, 4)} nats: {worst.name}. On {found.samples:,} samples."
    )
    figures = [_figures(found), _per_class(found)]
    return (
        f"<p><b>{escaped(brief)}</b></p>{_matrix(found)}"
        f'<p class="note">{NOTE}</p>{"".join(figures)}'
    )


def _matrix(found: ConditionTable) -> str:
    """Return the table of lost sensors by conditions."""
    heads = ["", "mean", *(row.name for row in found.rows)]
    whole = [row.entropy for row in found.rows]
    lines = [("Whole rig", whole, found.mean)]
    if len(found.sensors) > 1:
        lines += [
            (f"without {name}", [r.without[name] for r in found.rows], found.mean_without(name))
            for name in found.sensors
        ]
    values = [value for _, entropies, _ in lines for value in entropies]
    low, high = min(values), max(values)
    counted = [v for _, vs, _ in lines for v, r in zip(vs, found.rows, strict=True) if r.weight]
    rows = [
        [
            name,
            _cell(mean, low, high, False),
            *(_cell(v, low, high, v == max(counted)) for v in entropies),
        ]
        for name, entropies, mean in lines
    ]
    return table("Entropy by condition, with each sensor lost [nats]", heads, rows)


def _cell(value: float, low: float, high: float, is_worst: bool) -> Markup:
    share = (value - low) / (high - low) if high > low else 0.0
    red, green, blue = (round(p + (d - p) * share) for p, d in zip(PALE, DARK, strict=True))
    worst = " worst" if is_worst else ""
    style = f"background: rgb({red} {green} {blue}); color: #222"
    return Markup(f'<span class="heat{worst}" style="{style}">{number(value, 3)}</span>')


def _figures(found: ConditionTable) -> str:
    with_ap = any(row.ap is not None for row in found.rows)
    heads = ["", "weight", "entropy", "standard error", "coverage", *["AP"] * with_ap, "covered"]
    rows = [
        [
            row.name,
            number(row.weight, 3),
            number(row.entropy, 4),
            number(row.stderr, 4),
            percent(row.coverage, 1),
            *([number(row.ap or 0.0, 3)] if with_ap else []),
            _covered(row.covered or {}),
        ]
        for row in found.rows
    ]
    return table("Each condition", heads, rows, css="words")


def _covered(covered: dict[str, dict[str, float]]) -> str:
    """Return which parts cover sensors beyond what they cover as drawn."""
    return "; ".join(
        f"{sensor}: {', '.join(f'{part} {percent(share, 0)}' for part, share in parts.items())}"
        for sensor, parts in covered.items()
    )


def _per_class(found: ConditionTable) -> str:
    """Return AP by class where the study scores objects, else entropy by class."""
    with_ap = all(row.ap_per_class for row in found.rows)
    classes = list(dict.fromkeys(name for row in found.rows for name in row.per_class))
    rows = []
    for row in found.rows:
        values = (row.ap_per_class or {}) if with_ap else row.per_class
        rows.append([row.name, *(number(values[n], 3) if n in values else "" for n in classes)])
    what = "Expected AP by class" if with_ap else "Entropy by class [nats]"
    return table(what, ["", *classes], rows)
