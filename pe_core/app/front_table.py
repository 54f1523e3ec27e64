"""A Pareto front in a few lines, for people."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..study import Design, TradeOff, mounts_told


def front_summary(chosen: TradeOff) -> str:
    """Return the front as a table: price, entropy, coverage, and where each sensor sits."""
    unit = chosen.study.selection.currency
    head = (f"price [{unit}]" if unit else "price", "entropy", "coverage", "design")
    rows = [_figures(design) for design in chosen.front]
    widths = [max(map(len, column)) for column in zip(head, *rows, strict=True)]
    lines = [_line(head, widths)]
    for row, design in zip(rows, chosen.front, strict=True):
        lines += [_line(row, widths), *_placed(design, " " * (sum(widths[:3]) + 6))]
    return "\n".join([*lines, "", *told(chosen)])


def told(chosen: TradeOff) -> Iterator[str]:
    """Yield what was done, in words."""
    count, searched = len(chosen.designs) + len(chosen.refused), chosen.searched
    more = "of more" if chosen.stopped else "of more, by local search"
    every = "all that the limits allow" if chosen.is_complete else more
    yield f"{len(chosen.front)} on the front; {searched} searched of {count} looked at ({every})"
    if not searched:
        yield "none was searched in full: entropies are those of a first look"
    if chosen.stopped:
        yield "stopped early: this is the front of what was found so far"
    for name, why in chosen.refused.items():
        yield f"no place for {name}: {why}"


def _figures(design: Design) -> tuple[str, ...]:
    coverage = "-" if design.score is None else f"{design.score.coverage:.1%}"
    return (f"{design.price:,.10g}", f"{design.entropy:.4f}", coverage, design.name)


def _line(cells: tuple[str, ...], widths: list[int]) -> str:
    figures = (cell.rjust(width) for cell, width in zip(cells[:3], widths, strict=False))
    return "  ".join([*figures, cells[3]])


def _placed(design: Design, margin: str) -> Iterator[str]:
    """Yield where each sensor sits: its slot, or its place and the angles that are not zero."""
    mounts = mounts_told(design.study.rig, design.study.search.mounting)
    for sensor in design.study.rig:
        mount = mounts.get(sensor.name, {})
        slot = mount.get("slot")
        where = (
            f"{mount['mount']}, {slot}"
            if slot
            else _where(sensor.pose.position, sensor.pose.rotation_deg)
        )
        yield f"{margin}{sensor.name}: {sensor.model.name}; {where}"


def _where(position: Sequence[float], rotation: Sequence[float]) -> str:
    x, y, z = (round(value, 3) + 0.0 for value in position)
    angles = zip(("roll", "pitch", "yaw"), rotation, strict=True)
    turns = [f"{axis} {round(angle, 2):g} deg" for axis, angle in angles if round(angle, 2)]
    return ", ".join([f"({x:g}, {y:g}, {z:g}) m", *turns])
