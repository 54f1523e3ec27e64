"""What the rig sees where: ground maps, blind ground near the vehicle, reach by direction."""

from __future__ import annotations

from pe_core.scoring import sight

from ..markup import Markup, capitalized, escaped, table
from ..pictures.ground_plan import COVERAGE, ENTROPY, LAYERS, MapLayer, difference_map, ground_map
from ..pictures.sight_plans import blind_plan, reach_key, reach_plan, reach_text, side_text
from ..pictures.svg import STYLE, figure, figure_grid
from ..report_context import ReportContext, Section

STEP_M = 1.0
HEIGHTS = (0.0, 0.5, 1.5)
"""Heights of objects for which blind ground is shown [m]."""
HEIGHT_TEXT = {0.0: "flat on the ground", 0.5: "0.5 m tall", 1.5: "1.5 m tall"}
SIDES = {"front": "ahead", "left": "left", "right": "right", "rear": "behind"}
PREFERRED_CLASSES = ("pedestrian", "car")
"""Classes whose reach is shown, if the prior has them."""
BEARINGS_DEG = {"ahead": 0.0, "ahead left": 45.0, "left": 90.0, "behind": 180.0, "right": 270.0}
BEARINGS_DEG["ahead right"] = 315.0


def visibility(context: ReportContext) -> Section:
    """Return the maps and plans of a study."""
    inside = context.cached(
        "maps", lambda: f"{_ground_maps(context)}{_blind_ground(context)}{_reach_plans(context)}"
    )
    return Section("maps", "Visibility", inside, styles=(STYLE,))


def _ground_maps(context: ReportContext) -> str:
    """Return maps of the whole space; after a search also the maps before it."""
    ground = context.cached("ground", lambda: context.sight.ground(context.rig, step=STEP_M))
    titles = {layer.title: layer for layer in LAYERS}
    maps = [
        figure(ground_map(ground, layer, context.vehicle, _alt(context, title)), _caption(layer))
        for title, layer in titles.items()
    ]
    note = (
        "Maps seen from above: ahead is to the right, left is up. Dashed rings at 10 and 40 m from "
        "the vehicle's centre separate the zones near, middle and far."
    )
    before = _maps_before(context, ground) if context.was_searched else ""
    return f"<p>{note}</p>{figure_grid(maps)}{before}"


def _maps_before(context: ReportContext, ground: sight.GroundSight) -> str:
    """Return maps of the rig as it was given, and of the difference to it."""
    before = context.sight.ground(context.start.rig, step=STEP_M)
    maps = [
        figure(
            ground_map(before, layer, context.vehicle, f"{_alt(context, layer.title)}, before"),
            caption,
        )
        for layer, caption in (
            (ENTROPY, "<b>Entropy before</b>, same colours"),
            (COVERAGE, "<b>Coverage before</b>, same colours"),
        )
    ]
    ends = ("8 nats better", "8 nats worse")
    alt = f"Map of the change of entropy, {context.name}"
    difference = difference_map(before, ground, context.vehicle, alt, ends)
    maps.append(figure(difference, "<b>Change by the search</b>: blue is better, orange worse"))
    return f"<h3>Before the search</h3>{figure_grid(maps)}"


def _caption(layer: MapLayer) -> Markup:
    return Markup(f"<b>{escaped(layer.title)}</b>: {escaped(layer.about)}")


def _alt(context: ReportContext, title: str) -> str:
    return f"Map from above of {title.lower()}, {context.name}"


def _blind_ground(context: ReportContext) -> str:
    """Return plans of blind ground, and a table of its extent by side."""
    low, high = context.study.space.z
    by_height = {h: context.sight.blind(context.rig, h) for h in HEIGHTS if low <= h < high}
    if not by_height:
        return ""
    plans = [
        figure(
            blind_plan(blind, context.vehicle, f"Plan of ground blind to objects {h:g} m tall"),
            Markup(f"<b>Blind to objects {HEIGHT_TEXT[h]}</b>: {blind.area:.1f} m²"),
        )
        for h, blind in by_height.items()
    ]
    rows = [
        (capitalized(words), *(side_text(blind, side) for blind in by_height.values()))
        for side, words in SIDES.items()
    ]
    heads = ("side", *(f"{h:g} m tall" if h else "flat on the ground" for h in by_height))
    caption = "Blind ground within 10 m of the body: distance of the nearest, and its extent"
    note = (
        '<p class="note">Ground is blind for a height if a cylinder 0.3 m wide and exactly that '
        "tall can stand on it without a beam or pixel that meets it. Areas and distances are "
        "conservative: never too small, edges at most 0.15 m too far out. A side is the strip that "
        "the body sweeps in that direction; strips along the body narrower than 0.1 m do not "
        "count. A line from the body to a cap is the extent of blind ground that begins at the "
        "body. A ring marks the nearest blind ground that begins farther out.</p>"
    )
    extents = table(caption, heads, rows, css="words")
    return f"<h3>Blind ground near the vehicle</h3>{figure_grid(plans, 17.0)}{extents}{note}"


def _reach_plans(context: ReportContext) -> str:
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
        title = escaped(capitalized(name))
        lone = f"<b>A lone {escaped(name)}</b>, by eighths of the circle: AP 0.5 or more"
        caption = lone if reach.sector else f"<b>{title}</b>: AP 0.5 or more"
        plans.append(figure(plan, Markup(caption)))
        rows.append(_reach_row(capitalized(name), reach))
        if before is not None:
            rows.append(_reach_row(f"{name}, before", before))
    swatches = "".join(
        f'<li><span class="swatch" style="background:{color}"></span> {escaped(name)}</li>'
        for color, name in reach_key(context.rig)
    )
    key = f'<ul class="key" aria-label="Colours of sensors">{swatches}</ul>'
    what = "a lone object" if context.study.targets.are_objects else "an object"
    distances = table(
        f"Reach for {what}, from the vehicle's centre", ("class", *BEARINGS_DEG), rows
    )
    return f"<h3>Reach</h3>{figure_grid(plans)}{key}{distances}"


def _reach_row(name: str, reach: sight.Reach) -> tuple[str, ...]:
    return name, *(reach_text(reach, bearing) for bearing in BEARINGS_DEG.values())
