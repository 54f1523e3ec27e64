"""Sections about mounting: where sensors may go, and how they were built."""

from typing import Any

from ... import advice
from ..pictures.vehicle_picture import region_picture
from ..report_context import ReportContext


def free_regions(context: ReportContext) -> dict[str, Any] | None:
    """Return the free regions of sensors, each with its picture; None without any."""
    if not context.regions:
        return None
    rows = []
    for found in context.regions:
        least = found.tightest
        alt = f"The vehicle with the region in which {found.sensor} may go"
        rows.append(
            {
                "found": found,
                "lines": advice.region_lines(found),
                "tightest": None if least is None else least.text,
                "picture": region_picture(context, found, alt) if len(found.patch) else None,
            }
        )
    return {"regions": rows}


def as_built(context: ReportContext) -> dict[str, Any] | None:
    """Return how far each sensor is off and what that costs; None without a built rig."""
    found = context.built
    if found is None:
        return None
    heads, *rows = advice.built_table(found)
    return {"heads": heads[1:], "rows": rows, "lines": advice.built_sensor_lines(found)}
