"""What the rig sees where: maps, blind ground, reach, and what one lost sensor leaves."""

from __future__ import annotations

from typing import Any

from pe_core.base.errors import InputError
from pe_core.scoring.requirements import Redundancy

from ..markup import capitalized, percent
from ..pictures.ground_plan import COVERAGE, ENTROPY, LAYERS, count_map, difference_map, ground_map
from ..pictures.sight_plans import blind_plan, reach_plan, reach_text, side_text
from ..pictures.vehicle_picture import sensor_key
from ..report_context import MAP_STEP_M, ReportContext

HEIGHTS = (0.0, 0.5, 1.5)
"""Heights of objects for which blind ground is shown [m]."""
SIDES = {"front": "ahead", "left": "left", "right": "right", "rear": "behind"}
PREFERRED_CLASSES = ("pedestrian", "car")
"""Classes whose reach is shown, if the prior has them."""
BEARINGS_DEG = {"ahead": 0.0, "ahead left": 45.0, "left": 90.0, "behind": 180.0, "right": 270.0}
BEARINGS_DEG["ahead right"] = 315.0
HEIGHT_M, WITHIN_M, STEP_M = 0.8, 10.0, 0.25
"""Height of the test body, ground round the vehicle, and distance of the places [m]."""


def visibility(context: ReportContext) -> dict[str, Any]:
    """Return the maps and plans of a study."""
    return {
        **_ground_maps(context),
        **_blind_ground(context),
        **_reach(context),
        "key": sensor_key(context.rig),
    }


def _ground_maps(context: ReportContext) -> dict[str, Any]:
    """Return maps of the whole space; after a search also those before, and the difference."""

    def drawn(ground: Any, layer: Any, when: str = "") -> Any:
        alt = f"Map from above of {layer.title.lower()}, {context.name}{when}"
        return layer, ground_map(ground, layer, context.vehicle, alt)

    maps = {"maps": [drawn(context.ground, layer) for layer in LAYERS]}
    if not context.was_searched:
        return maps
    before = context.sight.ground(context.start.rig, step=MAP_STEP_M)
    ends = ("8 nats better", "8 nats worse")
    alt = f"Map of the change of entropy, {context.name}"
    return {
        **maps,
        "maps_before": [drawn(before, layer, ", before") for layer in (ENTROPY, COVERAGE)],
        "change": difference_map(before, context.ground, context.vehicle, alt, ends),
    }


def _blind_ground(context: ReportContext) -> dict[str, Any]:
    """Return plans of blind ground by height, and a table of its extent by side."""
    low, high = context.study.space.z
    found = {h: context.sight.blind(context.rig, h) for h in HEIGHTS if low <= h < high}
    alt = "Plan of ground blind to objects {:g} m tall"
    return {
        "blind_by_height": [
            (h, blind, blind_plan(blind, context.vehicle, alt.format(h)))
            for h, blind in found.items()
        ],
        "blind_heads": ["side", *(f"{h:g} m tall" if h else "flat on the ground" for h in found)],
        "blind_rows": [
            (capitalized(words), *(side_text(blind, side) for blind in found.values()))
            for side, words in SIDES.items()
        ],
    }


def _reach(context: ReportContext) -> dict[str, Any]:
    """Return plans and a table of the distance up to which objects are detected."""
    names = context.study.prior.class_names
    classes = [name for name in PREFERRED_CLASSES if name in names] or list(names[:1])
    bounds = context.study.space.x, context.study.space.y
    plans, rows = [], []
    for name in classes:
        reach = context.sight.reach(context.rig, name)
        before = context.sight.reach(context.start.rig, name) if context.was_searched else None
        alt = f"Plan of the reach for a {name}, {context.name}"
        plan = reach_plan(reach, before, context.rig, context.vehicle, bounds, alt)
        plans.append((name, bool(reach.sector), plan))
        for title, each in ((capitalized(name), reach), (f"{name}, before", before)):
            if each is not None:
                rows.append((title, *(reach_text(each, deg) for deg in BEARINGS_DEG.values())))
    return {"reach_plans": plans, "reach_heads": ["class", *BEARINGS_DEG], "reach_rows": rows}


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
