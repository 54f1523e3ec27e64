"""The table of a study's conditions as CSV, and as lines of a terminal."""

from __future__ import annotations

from pe_core.base import csv_text
from pe_core.study.condition_table import ConditionScore, ConditionTable

FIGURES = ("entropy", "stderr", "coverage")


def conditions_csv(table: ConditionTable) -> str:
    """Return a row for each condition: figures, entropy without each sensor, figures by class.

    In a study on objects the figures are AP and the reach ahead of lone objects [m], too.
    """
    classes = list(dict.fromkeys(name for row in table.rows for name in row.per_class))
    with_ap = any(row.ap is not None for row in table.rows)
    heads = ["state", "weather", "weight", *FIGURES, *["ap"] * with_ap]
    heads += [f"without {name}" for name in table.sensors]
    heads += [f"entropy of {name}" for name in classes]
    for figure in ("ap of", "reach ahead for") if with_ap else ():
        heads += [f"{figure} {name}" for name in classes]
    lines: list[list[object]] = [[*heads]]
    for row in table.rows:
        figures = [getattr(row, key) for key in FIGURES] + [row.ap] * with_ap
        without = [row.without[name] for name in table.sensors]
        by_class = [row.per_class.get(name, "") for name in classes]
        line: list[object] = [row.state, row.weather, row.weight, *figures, *without, *by_class]
        if with_ap:
            line += [(row.ap_per_class or {}).get(name, "") for name in classes]
            line += [(row.reach or {}).get(name, {}).get("front", "") for name in classes]
        lines.append(line)
    return csv_text(lines)


def condition_lines(table: ConditionTable) -> list[str]:
    """Return a line for each condition, and the mean and the worst of them."""
    worst = table.worst
    sensor, lossy = table.worst_loss
    lines = [f"conditions, on {table.samples:,} samples:", *map(_line, table.rows)]
    lines.append(f"mean of the conditions {table.mean:.4f} nats, worst {worst.entropy:.4f}")
    lines[-1] += f" ({worst.name})"
    if len(table.sensors) > 1:
        lines.append(
            f"worst with one sensor lost {lossy.without[sensor]:.4f} nats: "
            f"without {sensor}, {lossy.name}"
        )
    return lines


def _line(row: ConditionScore) -> str:
    ap = "" if row.ap is None else f", expected AP {row.ap:.3f}"
    return (
        f"  {row.name}: {row.entropy:.4f} nats, coverage {row.coverage:.1%}{ap}, "
        f"weight {row.weight:g}"
    )
