"""Redundancy: by how many sensors and kinds each place is seen, and what one lost sensor leaves."""

from __future__ import annotations

from typing import Any

from pe_core.base.errors import InputError
from pe_core.scoring.requirements import Redundancy

from ..markup import percent
from ..pictures.ground_plan import count_map
from ..report_context import ReportContext

HEIGHT_M, WITHIN_M, STEP_M = 0.8, 10.0, 0.25
"""Height of the test body, ground round the vehicle, and distance of the places [m]."""


def redundancy(context: ReportContext) -> dict[str, Any] | None:
    """Return the redundancy maps of a study; None for a rig of one sensor."""
    if len(context.rig) < 2:
        return None
    study = context.study
    try:
        seen = Redundancy(study.vehicle, study.space, HEIGHT_M, WITHIN_M, STEP_M).map(context.rig)
    except InputError as error:  # a kind of sensor that measures voxels alone
        return {"error": str(error)}
    cells = seen.cells
    bounds = (float(cells.x0[0]), float(cells.x1[-1])), (float(cells.y0[0]), float(cells.y1[-1]))
    maps = {
        "Sensors": ("that see the test body", seen.sensors),
        "Sensors left": ("the fewest when any one sensor is lost", seen.sensors_left),
        "Kinds": ("of sensors that see the test body", seen.kinds),
        "Kinds left": ("the fewest when any one sensor is lost", seen.kinds_left),
    }
    counts = [(f"{n} or more", (n, 1)) for n in range(1, len(seen.by_sensor) + 1)]
    counts += [(f"{n} kinds", (1, n)) for n in range(2, int(seen.kinds.max(initial=0)) + 1)]
    return {
        "error": "",
        "height_m": HEIGHT_M,
        "within_m": WITHIN_M,
        "maps": [
            (
                name,
                about,
                count_map(values, bounds, study.vehicle, f"Map of {name.lower()}, {context.name}"),
            )
            for name, (about, values) in maps.items()
        ],
        "shares": [
            (
                text,
                percent(seen.share(*least), 1),
                percent(seen.share(*least, one_lost=True), 1),
            )
            for text, least in counts
        ],
    }
