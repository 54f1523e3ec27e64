"""A comparison as a table of text."""

from __future__ import annotations

from collections.abc import Sequence

from ..advice import ComparedRow

BEST = "*"
TITLES = {
    "entropy": "entropy [nats], lower is better",
    "coverage": "seen, of where objects are",
    "ap": "expected AP",
    "reach": "reach ahead (AP 0.5) [m]",
    "blind": "blind ground [m2], lower is better",
}
WAYS = {
    "entropy": (".4f", 1.0),
    "coverage": (".1%", 100.0),
    "ap": (".3f", 1.0),
    "reach": (".1f", 1),
    "blind": (".1f", 1),
}
"""How figures of a measure are written, and by what their differences are multiplied."""
WIDEST = 24
"""Longer names of studies are cut at the front: their ends tell them apart."""


def comparison(names: Sequence[str], rows: Sequence[ComparedRow]) -> list[str]:
    """Return rows as lines, a column a study: the best is marked, differences are to the first."""
    heads = [name if len(name) <= WIDEST else f"...{name[3 - WIDEST :]}" for name in names]
    table = [["", *heads]]
    for measure, title in TITLES.items():
        own = [row for row in rows if row.measure == measure]
        if own:
            table.append([title, *[""] * len(heads)])
        table += [[f"  {row.name or 'all'}", *_cells(row)] for row in own]
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
    (way, times), mark = WAYS[row.measure], BEST if row.best[k] else " "
    figure = f"{value:{way}}"
    if k == 0 or less is None:
        return f"{figure}{mark}"
    change = f"{times * less:+{way.replace('%', 'f')}}"
    return f"{figure} ({change}){mark}"
