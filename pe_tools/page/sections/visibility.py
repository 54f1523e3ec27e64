"""What the rig sees where: maps, blind ground, reach, requirements, and what each sensor sees."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from markupsafe import Markup

from pe_core.base.errors import InputError
from pe_core.scoring import requirements
from pe_core.scoring.requirements import Redundancy

from ...wording import margin_text, unseen_text, verdict_text
from ..markup import capitalized, number, percent
from ..pictures.dimension_drawing import side_view, top_view
from ..pictures.ground_plan import COVERAGE, ENTROPY, LAYERS, count_map, difference_map, ground_map
from ..pictures.reference_figures import WorstBody, count_text, worst_bodies
from ..pictures.sensor_views import sensor_view
from ..pictures.sight_plans import blind_plan, reach_plan, reach_text, requirement_plan, side_text
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
DIGITS = 3
MAX_PARTS, MIN_SHARE = 3, 0.0005
"""Parts of the vehicle that a row names, and the smallest share that such a part occludes."""


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
            (text, percent(seen.share(*least), 1), percent(seen.share(*least, one_lost=True), 1))
            for text, least in counts
        ],
    }


def requirement_verdicts(context: ReportContext) -> dict[str, Any] | None:
    """Return the verdicts of a study; None for a study without requirements."""
    verdicts = context.outcome.verdicts
    if not verdicts:
        return None
    bodies = worst_bodies(verdicts, context.rig, context.vehicle)
    alts = [f"Zone of {v.name} from above: {'met' if v.met else 'not met'}" for v in verdicts]
    return {
        "verdicts": verdicts,
        "texts": [verdict_text(verdict.summary) for verdict in verdicts],
        "margins": [_margin(verdict) for verdict in verdicts],
        "unseen": ["" if v.met else unseen_text(v.unseen_by) for v in verdicts],
        "plans": [
            requirement_plan(verdict, context.vehicle, alt)
            for verdict, alt in zip(verdicts, alts, strict=True)
        ],
        "counts": [
            [f"{each.number} {each.verdict.name}: {each.body.name}"]
            + [
                count_text(sensor, count) if (count := each.counts[sensor.name]) > 0.0 else "none"
                for sensor in context.rig
            ]
            for each in bodies
        ],
        "pictures": list(_pictures(context, bodies)),
    }


def _margin(verdict: requirements.Verdict) -> str:
    if verdict.blind_m2 is not None:
        return margin_text(verdict.summary).replace("m2", "m²")
    share = "" if verdict.met else f"; {percent(verdict.share)} of the zone pass"
    return f"{margin_text(verdict.summary)}{share}"


def _pictures(
    context: ReportContext, bodies: tuple[WorstBody, ...]
) -> Iterator[tuple[str, Markup]]:
    """Yield name and picture of each sensor that sees a body."""
    for sensor in context.rig:
        picture = sensor_view(sensor.kind).picture
        seen = [each.figure(sensor) for each in bodies if each.counts[sensor.name] > 0.0]
        if picture is not None and seen:
            shown = picture(sensor, context.display_vehicle[0], seen)
            yield sensor.name, shown.svg(f"Test bodies in the picture of {sensor.name}")


def dimensions(context: ReportContext) -> dict[str, Any] | None:
    """Return side and top view with dimensions; None without a vehicle."""
    vehicle, axle = context.display_vehicle[0], context.study.reference
    if vehicle is None:
        return None
    axle_x = None if axle is None else axle.rear_axle_x
    length, width, _ = (vehicle.bounds[1] - vehicle.bounds[0]).tolist()
    front, height = float(vehicle.bounds[1][0]), float(vehicle.bounds[1][2])
    rows = []
    for k, sensor in enumerate(context.rig, 1):
        x, y, z = sensor.pose.position
        side = "" if abs(y) < 0.5 * 10.0**-DIGITS else " left" if y > 0.0 else " right"
        from_axle = [] if axle_x is None else [number(x - axle_x, DIGITS)]
        row = [f"{k} {sensor.name}", number(z, DIGITS), number(front - x, DIGITS), *from_axle]
        rows.append([*row, f"{number(abs(y), DIGITS)}{side}"])
    heads = ["Sensor", "above the ground", "behind the foremost point"]
    heads += [] if axle_x is None else ["forward of the rear axle"]
    return {
        "side": side_view(context.rig, vehicle, f"Side view of {context.name} with dimensions"),
        "top": top_view(
            context.rig, vehicle, axle_x, f"Top view of {context.name} with dimensions"
        ),
        **{"length": length, "width": width, "height": height, "axle": axle},
        "heads": [*heads, "from the centre line"],
        "rows": rows,
    }


def sensor_details(context: ReportContext) -> dict[str, Any]:
    """Return the parts that occlude each sensor, and what each one sees."""
    occluding = {}
    for name, score in context.after.per_sensor.items():
        shares = {part: count / score.beams for part, count in score.occluded_by.items()}
        parts = sorted((n for n in shares if shares[n] >= MIN_SHARE), key=lambda n: -shares[n])
        named = ", ".join(f"{part} {percent(shares[part], 1)}" for part in parts[:MAX_PARTS])
        occluding[name] = named or ("little" if score.occluded else "none")
    return {
        "occluding_parts": occluding,
        "key": sensor_key(context.rig),
        "views": [
            sensor_view(sensor.kind).figure(sensor, context.display_vehicle[0])
            for sensor in context.rig
        ],
    }
