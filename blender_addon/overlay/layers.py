"""What can be shown: a row a layer, in the order in which they are drawn."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..engine import graphics, pe
from . import asked, axles, blind, focus, ghosts, ground, heat, mounts, reach
from .tools import Tools
from .wish import ALL, BY_CHANNEL, BY_SENSOR, RIG, PictureWish, SceneSensor, ViewSettings

WHOLE_RIG = ""
"""Under this name stands what belongs to no single sensor."""
BLIND_WITHIN_M = 10.0
RING_ALPHA = 0.55
GHOST = 0.35
"""How strong stopped beams are where the body hides them: of many nothing else is seen."""
FRUSTUM_M, NOT_SELECTED = 1.0, 0.6
WITH_BEAMS = frozenset(name for name, drawing in graphics.DRAWINGS.items() if drawing.beams)


@dataclass(frozen=True, slots=True)
class Layer:
    """Something that can be switched on.

    `shapes` works it out: (wish, tools, what is asked for) to shapes by sensor, or by `WHOLE_RIG`.
    `keys` says what is asked for, and of each what it depends on: what has the same key as before
    is not worked out again. `rough` tells whether it is coarser while something moves, `edged`
    whether its lines have a dark edge: they lie on colours of all sorts.
    """

    name: str
    label: str
    keys: Callable[[PictureWish], dict[str, Hashable]]
    shape: Callable[[PictureWish, Tools, str], graphics.LayerShape]
    line_px: float = 1.2
    rough: bool = False
    on_ground: bool = False
    edged: bool = False


def _of_rig(*settings: str, prior: bool = True) -> Callable[[PictureWish], dict[str, Hashable]]:
    """Keys of a layer that shows the whole rig, and depends on these settings."""

    def keys(wish: PictureWish) -> dict[str, Hashable]:
        if not wish.counted or (prior and wish.prior is None):
            return {}
        who = tuple(each.key for each in wish.counted)
        chosen = tuple(getattr(wish.view, each) for each in settings)
        return {WHOLE_RIG: (who, wish.body_key, wish.prior_key if prior else None, chosen)}

    return keys


def _rig(wish: PictureWish) -> pe.Rig:
    return pe.Rig([each.sensor for each in wish.counted])


def _ground_keys(wish: PictureWish) -> dict[str, Hashable]:
    settings = ("ground_quantity", "ground_height", "ground_opacity", "ground_range")
    keys = _of_rig(*settings, "entropy_range", "coverage_range")(wish)
    more = id(ground.as_scored(wish)), ground.compared_key(wish)
    return {name: (key, more) for name, key in keys.items()}


def _ground(wish: PictureWish, tools: Tools, _name: str) -> graphics.LayerShape:
    return ground.ground(wish, tools)


def _blind(wish: PictureWish, tools: Tools, _name: str) -> graphics.LayerShape:
    height = wish.view.blind_height
    found = tools.sight(wish).blind(_rig(wish), height, within=BLIND_WITHIN_M, draft=wish.moving)
    body = None if wish.vehicle is None else wish.vehicle.bounds
    return blind.blind_ground(found, body, height)


def _reach_keys(wish: PictureWish) -> dict[str, Hashable]:
    keys = _of_rig("reach_class", "reach_of")(wish)
    chosen = tuple(each.sensor.name for each in wish.counted if each.selected)
    return {name: (key, chosen) for name, key in keys.items()}


def _reach(wish: PictureWish, tools: Tools, _name: str) -> graphics.LayerShape:
    view = wish.view
    known = wish.prior.class_names
    of = view.reach_class if view.reach_class in known else known[0]
    found = tools.sight(wish).reach(
        _rig(wish), of, ap=reach.AP, bearings=reach.BEARINGS, draft=wish.moving
    )
    whole = reach.reach_of_rig(found)
    if view.reach_of == RIG:
        return whole
    everyone = view.reach_of == ALL
    named = {e.sensor.name: e.number for e in wish.counted if everyone or e.selected}
    alone = reach.reach_of_sensors(found, named)
    legend = graphics.ColorKey(
        whole.legend.title, classes=whole.legend.classes + alone.legend.classes
    )
    return graphics.LayerShape(
        graphics.Primitives.joined([alone.lines, whole.lines]), labels=whole.labels, legend=legend
    )


def _beam_keys(wish: PictureWish) -> dict[str, Hashable]:
    view, shown = wish.view, wish.of_beams(WITH_BEAMS)
    budget = graphics.beam_budget([each.sensor for each in shown], view.beam_limit)
    chosen = view.channels, view.channel, view.beam_colors, view.rings, view.beam_length, budget
    return {each.sensor.name: (each.key, wish.body_key, chosen) for each in shown}


def _beams(wish: PictureWish, tools: Tools, name: str) -> graphics.LayerShape:
    view, shown = wish.view, wish.of_beams(WITH_BEAMS)
    of = next(each for each in shown if each.sensor.name == name)
    budget = graphics.beam_budget([each.sensor for each in shown], view.beam_limit)
    choice = graphics.BeamChoice(budget, graphics.ChannelMode(view.channels), view.channel)
    found = tools.cast(wish, of)
    beams = graphics.shown_beams(found, choice)
    colors = _beam_colors(of, view, beams.channel, beams.stopped)
    around = None if wish.vehicle is None else wish.vehicle.bounds
    parts = [graphics.free_lines(of.sensor, beams, view.beam_length, colors, around)]
    if view.rings:
        rows = graphics.channels_of(of.sensor.model, choice)
        whole = _beam_colors(of, view, rows, np.zeros(len(rows), bool))
        whole[:, 3] = RING_ALPHA
        parts.append(graphics.ground_rings(found, rows, whole))
    stopped = graphics.stopped_lines(of.sensor, beams, colors)
    ghosts = graphics.Primitives.of(stopped.points, stopped.colors * [1.0, 1.0, 1.0, GHOST])
    lines = graphics.Primitives.joined([*parts, stopped])
    return graphics.LayerShape(lines=lines, through=ghosts, legend=_beam_legend(view))


def _beam_colors(
    of: SceneSensor, view: ViewSettings, channel: NDArray[np.int64], stopped: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """(N, 4) colours of beams of these channels."""
    by_sensor = view.beam_colors == BY_SENSOR
    palette = graphics.sensor_palette(of.number) if by_sensor else graphics.VIEWPORT
    free, hit = (np.float32(c) for c in (palette.free, palette.stopped))
    colors = np.where(stopped[:, None], hit, free)
    if view.beam_colors == BY_CHANNEL:
        rank = np.argsort(np.argsort(of.sensor.model.elevations, kind="stable"))
        colors[:, :3] = graphics.on_scale(rank[channel] / max(len(rank) - 1, 1), graphics.VIRIDIS)
    return colors


def _beam_legend(view: ViewSettings) -> graphics.ColorKey:
    if view.beam_colors == BY_CHANNEL:
        row = graphics.on_scale(np.linspace(0.0, 1.0, graphics.SWATCHES), graphics.VIRIDIS)
        swatches = tuple((*map(float, color), 1.0) for color in row)
        return graphics.ColorKey("Channel", swatches, ("lowest", "highest"))
    palette = graphics.VIEWPORT
    stopped = (graphics.with_alpha(palette.stopped, 1.0), "stopped by the vehicle")
    if view.beam_colors == BY_SENSOR:  # free beams have the colours of the names
        return graphics.ColorKey("Beams", classes=(stopped,))
    return graphics.ColorKey(
        "Beams", classes=((graphics.with_alpha(palette.free, 1.0), "free"), stopped)
    )


def _heat_keys(wish: PictureWish) -> dict[str, Hashable]:
    who = tuple(each.key for each in wish.of_beams(WITH_BEAMS))
    return {WHOLE_RIG: (who, wish.body_key)} if who and wish.vehicle is not None else {}


def _heat(wish: PictureWish, tools: Tools, _name: str) -> graphics.LayerShape:
    found = [tools.cast(wish, each) for each in wish.of_beams(WITH_BEAMS)]
    return heat.heat(found, tools.body(wish).triangles)


def _view_keys(wish: PictureWish) -> dict[str, Hashable]:
    view = wish.view
    shown = [e for e in wish.sensors if e.drawn and e.sensor.kind not in WITH_BEAMS]
    return {e.sensor.name: (e.key, e.selected, view.footprints, view.view_range) for e in shown}


def _views(wish: PictureWish, _tools: Tools, name: str) -> graphics.LayerShape:
    of = next(each for each in wish.sensors if each.sensor.name == name)
    drawing = graphics.drawing_of(of.sensor.kind)
    sketch = drawing.sketch(of.sensor, None, graphics.BeamChoice(1))
    palette = graphics.sensor_palette(of.number)
    lines, faces = [sketch.lines(FRUSTUM_M, palette)], [sketch.faces(FRUSTUM_M, palette)]
    if drawing.footprint is not None and wish.view.footprints:
        outline = drawing.footprint(of.sensor, wish.view.view_range)
        lines.append(graphics.footprint_lines(outline, palette.camera))
        faces.append(graphics.footprint_faces(outline, palette.camera_face))
    shown, filled = graphics.Primitives.joined(lines), graphics.Primitives.joined(faces)
    for part in (shown, filled):
        part.colors[:, 3] *= 1.0 if of.selected else NOT_SELECTED
    return graphics.LayerShape(shown, filled)


def _label_keys(wish: PictureWish) -> dict[str, Hashable]:
    return {e.sensor.name: (e.key, e.selected) for e in wish.sensors if e.drawn}


def _label(wish: PictureWish, _tools: Tools, name: str) -> graphics.LayerShape:
    of = next(each for each in wish.sensors if each.sensor.name == name)
    color = graphics.with_alpha(graphics.sensor_color(of.number), 1.0)
    return graphics.LayerShape(
        labels=(graphics.Tag(name, of.sensor.pose.position, color, strong=of.selected),)
    )


def _ghost_keys(wish: PictureWish) -> dict[str, Hashable]:
    if not wish.ghosts:
        return {}
    others = tuple((s.name, id(s.model), s.pose, s.group, s.curve) for s in wish.ghosts)
    here = tuple((each.sensor.name, each.sensor.pose) for each in wish.counted)
    reach_too = "reach" in wish.view.layers and wish.prior is not None
    reached = (wish.body_key, wish.prior_key, wish.view.reach_class) if reach_too else None
    return {WHOLE_RIG: (others, here, wish.ghosts_name, reached)}


def _ghosts(wish: PictureWish, tools: Tools, _name: str) -> graphics.LayerShape:
    here, of = [e.sensor for e in wish.counted], "Search" if wish.searching else ghosts.VARIANT
    shape = ghosts.ghosts(wish.ghosts, here, wish.ghosts_name, of)
    if wish.searching:
        return shape
    if "reach" not in wish.view.layers or wish.prior is None:
        return shape
    rig, known = pe.Rig(wish.ghosts), wish.prior.class_names
    of = wish.view.reach_class if wish.view.reach_class in known else known[0]
    line = reach.rig_reach(tools.sight(wish), rig, of, ghosts.GHOSTS, wish.ghosts_name)
    return replace(shape, lines=line.lines)


def _place_keys(wish: PictureWish) -> dict[str, Hashable]:
    place = wish.place
    if place is None:
        return {}
    told = tuple((s.name, s.reason, s.m) for s in place.sensors)
    here = tuple((each.sensor.name, each.sensor.pose) for each in wish.counted)
    return {WHOLE_RIG: (place.center, place.ap, told, here)}


def _place(wish: PictureWish, _tools: Tools, _name: str) -> graphics.LayerShape:
    return asked.asked_place(wish.place, [each.sensor for each in wish.counted])


def _mount_keys(wish: PictureWish) -> dict[str, Hashable]:
    if not wish.mounts and not wish.boxes:
        return {}
    return {WHOLE_RIG: (tuple((each.key, each.strong) for each in wish.mounts), wish.boxes)}


def _mounts(wish: PictureWish, _tools: Tools, _name: str) -> graphics.LayerShape:
    return mounts.mounts(wish.mounts, wish.boxes)


def _focus_keys(wish: PictureWish) -> dict[str, Hashable]:
    return {WHOLE_RIG: (wish.focus, wish.space)} if wish.focus and wish.space is not None else {}


def _focus(wish: PictureWish, _tools: Tools, _name: str) -> graphics.LayerShape:
    return focus.focus_regions(wish.focus, wish.space)


def _axle_keys(wish: PictureWish) -> dict[str, Hashable]:
    return {} if wish.reference is None else {WHOLE_RIG: (wish.reference, wish.body_key)}


def _axles(wish: PictureWish, _tools: Tools, _name: str) -> graphics.LayerShape:
    half = None if wish.vehicle is None else float(wish.vehicle.bounds[1][1])
    return axles.axles(wish.reference, half)


LAYERS = (
    Layer(
        "ground",
        "Ground Map",
        _ground_keys,
        _ground,
        rough=True,
        on_ground=True,
    ),
    Layer(
        "blind",
        "Blind Ground",
        _of_rig("blind_height", prior=True),
        _blind,
        1.6,
        rough=True,
        on_ground=True,
        edged=True,
    ),
    Layer("reach", "Reach", _reach_keys, _reach, 2.2, rough=True, on_ground=True, edged=True),
    Layer("mounts", "Mounts", _mount_keys, _mounts, 1.4, edged=True),
    Layer("focus", "Focus", _focus_keys, _focus, 1.4, edged=True),
    Layer("frustums", "Camera Views", _view_keys, _views),
    Layer("beams", "Beams", _beam_keys, _beams, rough=True),
    Layer("heat", "Stopped Where", _heat_keys, _heat, rough=True),
    Layer("axles", "Axles", _axle_keys, _axles, 1.6, edged=True),
    Layer("ghosts", "Other Variant", _ghost_keys, _ghosts, 1.6, edged=True),
    Layer("place", "Asked Place", _place_keys, _place, 1.8, edged=True),
    Layer("labels", "Names", _label_keys, _label),
)
assert all(a.name != b.name for a, b in pairwise(LAYERS))
