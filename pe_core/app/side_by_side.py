"""A comparison as a table of text."""

from __future__ import annotations

from collections.abc import Sequence

from ..advice import ComparedRow

BEST = "*"
TITLES = {"entropy": "entropy [nats], lower is better", "coverage": "seen, of where objects are"}
WIDEST = 24
"""Longer names of studies are cut at the front: their ends tell them apart."""


def comparison(names: Sequence[str], rows: Sequence[ComparedRow]) -> list[str]:
    """Return rows as lines, a column a study: the best is marked, differences are to the first."""
    heads = [name if len(name) <= WIDEST else f"...{name[3 - WIDEST :]}" for name in names]
    table = [["", *heads]]
    for measure, title in TITLES.items():
        table.append([title, *[""] * len(heads)])
        table += [
            [f"  {row.name or 'all'}", *_cells(row)] for row in rows if row.measure == measure
        ]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    lines = [_line(cells, widths) for cells in table]
    return [*lines, f"{BEST} best; in brackets the difference to {heads[0]}"]


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    figures = (cell.rjust(width) for cell, width in zip(cells[1:], widths[1:], strict=True))
    return "  ".join([cells[0].ljust(widths[0]), *figures]).rstrip()


def _cells(row: ComparedRow) -> list[str]:
    return [_cell(row, k) for k in range(len(row.values))]


def _cell(row: ComparedRow, k: int) -> str:
    value, less = row.values[k], row.differences[k]
    if value is None:
        return "- "
    in_nats, mark = row.measure == "entropy", BEST if row.best[k] else " "
    figure = f"{value:.4f}" if in_nats else f"{value:.1%}"
    if k == 0 or less is None:
        return f"{figure}{mark}"
    change = f"{less:+.4f}" if in_nats else f"{100.0 * less:+.1f}"
    return f"{figure} ({change}){mark}"
