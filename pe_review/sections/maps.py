"""What is seen where: maps from above, blind ground near the vehicle, reach by direction."""

from __future__ import annotations

from ..engine import sight
from ..figures import up_first
from ..markup import Markup, escaped, table
from ..pictures.blind_plan import blind_plan, side_words
from ..pictures.ground_maps import COVERAGE, ENTROPY, LAYERS, MapLayer, difference_map, ground_map
from ..pictures.reach_plan import reach_key, reach_plan, reach_to
from ..pictures.svg import STYLE, figure, grid
from ..reviewed import Reviewed
from ..section import Section

STEP_M = 1.0
HEIGHTS = (0.0, 0.5, 1.5)
"""How tall what stands on the ground is for which blind ground is shown [m]."""
TALL = {0.0: "flat on the ground", 0.5: "0.5 m tall", 1.5: "1.5 m tall"}
SIDES = {"front": "ahead", "left": "left", "right": "right", "rear": "behind"}
USUAL = ("pedestrian", "car")
"""Classes whose reach is shown, where the prior has them."""
FOUND_UP_TO = "Found up to, from the middle"
WAYS = {"ahead": 0.0, "ahead left": 45.0, "left": 90.0, "behind": 180.0, "right": 270.0}
WAYS["ahead right"] = 315.0


def maps(one: Reviewed) -> Section:
    """Return the maps of a study."""
    inside = one.once("maps", lambda: f"{_ground(one)}{_blind(one)}{_reach(one)}")
    return Section("maps", "What is seen where", inside, styles=(STYLE,))


def _ground(one: Reviewed) -> str:
    """Maps of all of the ground; after a search what it was before, and what changed."""
    seen = one.once("ground", lambda: one.sight.ground(one.rig, step=STEP_M))
    titles = {layer.title: layer for layer in LAYERS}
    drawn = [
        figure(ground_map(seen, layer, one.vehicle, _alt(one, title)), _caption(layer))
        for title, layer in titles.items()
    ]
    words = (
        "From above: ahead is to the right, left is up. Dashed rings are 10 and 40 m from the "
        "middle, where near, middle and far meet."
    )
    return f"<p>{words}</p>{grid(drawn)}{_before(one, seen) if one.searched else ''}"


def _before(one: Reviewed, seen: sight.GroundSight) -> str:
    """Return the maps of the rig as it was given, and the difference to it."""
    before = one.sight.ground(one.asked.rig, step=STEP_M)
    drawn = [
        figure(ground_map(before, layer, one.vehicle, f"{_alt(one, layer.title)}, before"), about)
        for layer, about in (
            (ENTROPY, "<b>Entropy before</b>, in the same colours"),
            (COVERAGE, "<b>Coverage before</b>, in the same colours"),
        )
    ]
    ends = ("8 nats better", "8 nats worse")
    alt = f"Map of the change of entropy, {one.name}"
    changed = difference_map(before, seen, one.vehicle, alt, ends)
    drawn.append(figure(changed, "<b>What the search changed</b>: blue is better, orange worse"))
    return f"<h3>Before the search</h3>{grid(drawn)}"


def _caption(layer: MapLayer) -> Markup:
    return Markup(f"<b>{escaped(layer.title)}</b>: {escaped(layer.about)}")


def _alt(one: Reviewed, title: str) -> str:
    return f"Map from above of {title.lower()}, {one.name}"


def _blind(one: Reviewed) -> str:
    """Plans of blind ground, and its metres by side."""
    heights = [h for h in HEIGHTS if one.found.space.z[0] <= h < one.found.space.z[1]]
    found = {height: one.sight.blind(one.rig, height) for height in heights}
    if not found:
        return ""
    drawn = [
        figure(
            blind_plan(each, one.vehicle, f"Plan of ground blind to what is {height:g} m tall"),
            Markup(f"<b>Blind to what is {TALL[height]}</b>: {each.area:.1f} m²"),
        )
        for height, each in found.items()
    ]
    rows = [
        (up_first(words), *(side_words(each, side) for each in found.values()))
        for side, words in SIDES.items()
    ]
    heads = ("side", *(f"{h:g} m tall" if h else "flat on the ground" for h in found))
    caption = "Blind ground within 10 m of the body: where the nearest is, and how far it goes"
    note = (
        '<p class="note">Blind ground is what a cylinder 0.3 m wide and exactly so tall can stand '
        "on while no beam and no pixel meets it. Areas and distances err to the safe side: never "
        "too small, and edges at most 0.15 m too far out. Sides are the strips that the body "
        "sweeps to each; a strip along the body narrower than 0.1 m is none. A line from the body "
        "to a cap is how far blind ground that begins at the body reaches; a ring is the nearest "
        "blind ground that begins farther out.</p>"
    )
    shown = f"{grid(drawn, 17.0)}{table(caption, heads, rows, css='words')}{note}"
    return f"<h3>Blind ground near the vehicle</h3>{shown}"


def _reach(one: Reviewed) -> str:
    """Plans and metres of how far away objects are found."""
    names = one.found.prior.class_names
    classes = [name for name in USUAL if name in names] or list(names[:1])
    bounds = one.found.space.x, one.found.space.y
    drawn, rows = [], []
    for name in classes:
        found = one.sight.reach(one.rig, name)
        before = one.sight.reach(one.asked.rig, name) if one.searched else None
        alt = f"Plan of how far a {name} is found, {one.name}"
        plan = reach_plan(found, before, one.rig, one.vehicle, bounds, alt)
        alone = f"<b>A lone {escaped(name)}</b> found, by eighths of the circle: AP 0.5 or more"
        caption = f"<b>{escaped(up_first(name))}</b> found: AP 0.5 or more"
        caption = alone if found.sector else caption
        drawn.append(figure(plan, Markup(caption)))
        rows.append((up_first(name), *(reach_to(found, way) for way in WAYS.values())))
        if before is not None:
            rows.append((f"{name}, before", *(reach_to(before, way) for way in WAYS.values())))
    swatches = "".join(
        f'<li><span class="swatch" style="background:{color}"></span> {escaped(name)}</li>'
        for color, name in reach_key(one.rig)
    )
    key = f'<ul class="key" aria-label="Colours of sensors">{swatches}</ul>'
    of_objects = one.found.targets.are_objects
    what = "A lone object is found up to, from the middle" if of_objects else FOUND_UP_TO
    shown = f"{grid(drawn)}{key}{table(what, ('class', *WAYS), rows)}"
    return f"<h3>How far away objects are found</h3>{shown}"
