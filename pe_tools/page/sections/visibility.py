"""What the rig sees where: maps, blind ground, reach, requirements, and what each sensor sees."""

import base64
import math
from collections.abc import Sequence
from itertools import starmap
from typing import Any

from pe_core.motion import WINDOW, DriveBy
from pe_core.scoring.sight import reach_text

from ... import graphics
from ..markup import TEMPLATES, capitalized, percent
from ..pictures.ground_plan import COVERAGE, ENTROPY, LAYERS, difference_map, ground_map
from ..pictures.reference_figures import count_text, worst_bodies
from ..pictures.sensor_views import sensor_view
from ..pictures.sight_plans import blind_plan, reach_plan, requirement_plan, side_text
from ..pictures.time_strip import strip_data, time_strip
from ..pictures.vehicle_picture import sensor_key
from ..report_context import MAP_STEP_M, ReportContext

CHANGE_ENDS = ("8 nats better", "8 nats worse")
HEIGHTS = (0.0, 0.5, 1.5)  # Heights of objects for which blind ground is shown [m]
SIDES = {"front": "ahead", "left": "left", "right": "right", "rear": "behind"}
PREFERRED_CLASSES = ("pedestrian", "car")  # Classes whose reach is shown, if the prior has them
WAYS_DEG = {"ahead": 0, "ahead left": 45, "left": 90, "behind": 180, "right": 270}
WAYS_DEG["ahead right"] = 315
MAX_PARTS = 3
MIN_SHARE = 0.0005
"""Parts of the vehicle that a row names, and the smallest share that such a part occludes."""


def visibility(context: ReportContext) -> dict[str, Any]:
    """Return maps of the whole space, plans of blind ground by height, and of the reach by class.
    After a search the maps are also those before it, with the difference."""
    rig = context.rig
    vehicle = context.vehicle
    study = context.study
    sight = context.sight

    def drawn(ground: Any, layer: Any, when: str = "") -> Any:
        alt = f"Map from above of {layer.title.lower()}, {context.name}{when}"
        return layer, ground_map(ground, layer, vehicle, alt)

    maps: dict[str, Any] = {"maps": [drawn(context.ground, layer) for layer in LAYERS]}
    if context.was_searched:
        before = sight.ground(context.start.rig, step=MAP_STEP_M)
        alt = f"Map of the change of entropy, {context.name}"
        maps["maps_before"] = [drawn(before, layer, ", before") for layer in (ENTROPY, COVERAGE)]
        maps["change"] = difference_map(before, context.ground, vehicle, alt, ends=CHANGE_ENDS)
    blind_by_height = []
    for height in (h for h in HEIGHTS if study.space.z[0] <= h < study.space.z[1]):
        blind = sight.blind(rig, height)
        alt = f"Plan of ground blind to objects {height:g} m tall"
        blind_by_height.append((height, blind, blind_plan(blind, vehicle, alt)))
    names = study.prior.class_names
    plans = []
    rows = []
    for name in [name for name in PREFERRED_CLASSES if name in names] or list(names[:1]):
        reach = sight.reach(rig, name)
        was = sight.reach(context.start.rig, name) if context.was_searched else None
        alt = f"Plan of the reach for a {name}, {context.name}"
        plan = reach_plan(reach, was, rig, vehicle, bounds=(study.space.x, study.space.y), alt=alt)
        plans.append((name, bool(reach.sector), plan))
        for title, each in ((capitalized(name), reach), (f"{name}, before", was)):
            if each is not None:
                told = map(each.towards, map(math.radians, WAYS_DEG.values()))
                rows.append((title, *starmap(reach_text, told)))
    return {
        **maps,
        "blind_by_height": blind_by_height,
        "sides": SIDES,
        "side_text": side_text,
        "reach_plans": plans,
        "reach_heads": ["class", *WAYS_DEG],
        "reach_rows": rows,
        "key": sensor_key(rig),
    }


def drive_by(context: ReportContext) -> dict[str, Any] | None:
    """Return the scenarios of a study, as its rig sees them; None for a study without scenarios."""
    folder = context.folder
    films = [p.read_bytes() for p in sorted(folder.glob("*.webm"))] if folder is not None else []
    driven = [context.study.drive_by(each, context.rig) for each in context.study.scenarios]
    strips = [
        (
            each,
            body,
            time_strip(each.scenario, body, f"{body.name} in {each.scenario.name} over time"),
        )
        for each in driven
        for body in each.bodies
    ]
    shown = {each.scenario.name: _film_of(each, films) for each in driven}
    data = {each.scenario.name: strip_data(each.scenario) for each in driven}
    if not driven:
        return None
    return {"driven": driven, "strips": strips, "films": shown, "data": data, "window": WINDOW}


def _film_of(driven: DriveBy, films: Sequence[bytes]) -> str:
    """Return the film of a drive-by as the URL of its data; empty where it is of another one."""
    mark = graphics.digest(driven).encode()
    found = next((data for data in films if mark in data), b"")
    return f"data:video/webm;base64,{base64.b64encode(found).decode()}" if found else ""


def strip_script() -> tuple[str, ...]:
    """Return the program that moves the cursors of strips, and films with them."""
    return ((TEMPLATES / "strip.js").read_text("utf-8"),)


def requirement_verdicts(context: ReportContext) -> dict[str, Any] | None:
    """Return the verdicts of a study; None for a study without requirements."""
    verdicts = context.outcome.verdicts
    if not verdicts:
        return None
    bodies = worst_bodies(verdicts, context.rig, context.vehicle)
    plans = []
    for verdict in verdicts:
        alt = f"Zone of {verdict.name} from above: {'met' if verdict.met else 'not met'}"
        plans.append(requirement_plan(verdict, context.vehicle, alt))
    return {"verdicts": verdicts, "plans": plans, "bodies": bodies, "count_text": count_text}


def sensor_details(context: ReportContext) -> dict[str, Any]:
    """Return the parts that occlude each sensor, and what each one sees."""
    occluding = {}
    for name, score in context.after.per_sensor.items():
        shares = {part: count / score.beams for part, count in score.occluded_by.items()}
        parts = sorted((n for n in shares if shares[n] >= MIN_SHARE), key=lambda n: -shares[n])
        named = ", ".join(f"{part} {percent(shares[part], 1)}" for part in parts[:MAX_PARTS])
        occluding[name] = named or ("little" if score.occluded else "none")
    told = {sensor.name: context.study.distances(sensor) for sensor in context.rig}
    return {
        "occluding_parts": occluding,
        "distances": {name: texts for name, texts in told.items() if texts},
        "key": sensor_key(context.rig),
        "views": [
            sensor_view(sensor.kind).figure(sensor, context.display_vehicle[0])
            for sensor in context.rig
        ],
    }
