"""A Pareto front in lines of text: its designs with their objectives, and notes on the search."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pe_core.search.figures import PRICE, figure_of
from pe_core.study import mounts_table

from .. import jobs


def front_summary(chosen: jobs.TradeOff) -> str:
    """Return the front as a table: the objectives of each design, and the pose of each sensor."""
    named = [name for name in chosen.objectives if all(name in d.figures for d in chosen.front)]
    named += [name for d in chosen.front[:1] for name in d.figures if name not in named]
    currency = chosen.study.selection.currency
    heads = [figure_of(name, currency).title for name in named]
    rows = [[_figure(design, name) for name in named] for design in chosen.front]
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]

    def line(cells: Sequence[str], name: str) -> str:
        figures = (cell.rjust(width) for cell, width in zip(cells, widths, strict=True))
        return "  ".join([*figures, name])

    lines = [line(heads, "design")]
    for row, design in zip(rows, chosen.front, strict=True):
        met = f" ({design.met_text})" if design.met_text else ""
        lines += [line(row, f"{design.name}{met}"), *_placed(design, " " * (sum(widths) + 2))]
    return "\n".join([*lines, "", *search_notes(chosen)])


def search_notes(chosen: jobs.TradeOff) -> Iterator[str]:
    """Yield sentences about the search: numbers of designs, requirements, infeasible designs."""
    yield chosen.told
    if not chosen.searched:
        yield "none was searched in full: figures are those of a first look"
    if chosen.requirements_note:
        yield chosen.requirements_note
    yield from chosen.notes
    if chosen.stopped:
        yield "stopped early: this is the front of what was found so far"
    for name, why in chosen.refused.items():
        yield f"no place for {name}: {why}"


def _figure(design: jobs.Design, name: str) -> str:
    value = design.figures[name]
    if name == PRICE:
        return f"{value:,.10g}"
    if design.is_infeasible:
        return "infeasible"
    return figure_of(name).number(value)


def _placed(design: jobs.Design, margin: str) -> Iterator[str]:
    """Yield a line for each sensor: its slot, or its position and the nonzero angles."""
    mounts = mounts_table(design.study.rig, design.study.search.mounting)
    for sensor in design.study.rig:
        mount = mounts.get(sensor.name, {})
        slot = mount.get("slot")
        pose = sensor.pose
        where = f"{mount['mount']}, {slot}" if slot else _where(pose.position, pose.rotation_deg)
        where = "; ".join([where, *design.study.distances(sensor)])
        yield f"{margin}{sensor.name}: {sensor.model.name}; {where}"


def _where(position: Sequence[float], rotation: Sequence[float]) -> str:
    x, y, z = (round(value, 3) + 0.0 for value in position)
    angles = zip(("roll", "pitch", "yaw"), rotation, strict=True)
    turns = [f"{axis} {round(angle, 2):g} deg" for axis, angle in angles if round(angle, 2)]
    return ", ".join([f"({x:g}, {y:g}, {z:g}) m", *turns])
