"""The table of layers: a row a layer, in the order in which they are drawn."""

from collections.abc import Callable, Generator, Hashable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..engine import advice, engine_process, graphics, kinds, motion, pe, requirements
from ..view.view_settings import ALL, BY_CHANNEL, BY_SENSOR, RIG, ViewSettings
from . import ground_layers, heatmap, regions
from .annotations import (
    GHOST_PALETTE,
    GHOST_TITLE,
    axles,
    front_arrow,
    ghost_sensors,
    location_mark,
)
from .birds_eye import birds_eye
from .layer_cache import LayerCache
from .place_colors import place_colors, region_patch
from .request import SceneSensor, ViewRequest
from .requirement_zones import requirement_zones
from .way_arrow import way_arrow

WHOLE_RIG = ""
OTHER_RIG = "\0other variant"
"""The names of shapes that belong to no single sensor: of the scene, and of the variant that a wipe
shows beside it."""
BIRDS_EYE = "birds_eye"
"""The layer that is a plate over the view: `operators.birds_eye` draws it."""
BLIND_WITHIN_M = 10.0
RING_ALPHA = 0.55
OCCLUDED_ALPHA = 0.35
"""Opacity of blocked beams behind the vehicle: many of them would hide all else."""
FRUSTUM_M = 1.0
UNSELECTED_ALPHA = 0.6
STEERING = "steering"
"""A lane of its own: the best way of a dragged sensor waits for no map."""
MOVED_SAMPLES = 16_384
IDLE_SAMPLES = 65_536
"""Voxels of the best way while something moves, and of an idle scene."""

LayerKeys = Callable[[ViewRequest], dict[str, Hashable]]
ShapeSteps = Generator[graphics.LayerShape | None, None, graphics.LayerShape]
LayerMaker = Callable[[ViewRequest, LayerCache, str], graphics.LayerShape | ShapeSteps]
"""What makes a shape, at once or in steps; a step may have a shape for the time being."""
ZONES: dict[str, Any] = {"on_ground": True, "edged": True}


@dataclass(frozen=True, slots=True)
class Layer:
    """A layer that can be switched on.

    `keys` returns the names of the layer's shapes for a request: names of sensors, or `WHOLE_RIG`.
    Each name has a key of everything that the shape depends on; a shape with an unchanged key is
    not made again. `shape` makes a shape from request, cache and name. `rough`: the shape is
    approximate while something moves. `on_ground`: it is drawn in front of the ground. `edged`: its
    lines have a dark edge, because their background has many colours. `lane`: where the engine
    makes it; a shape that pauses between its steps is given up there when something moves.
    """

    name: str
    label: str
    keys: LayerKeys
    shape: LayerMaker
    line_px: float = 1.2
    rough: bool = False
    on_ground: bool = False
    edged: bool = False
    lane: str = engine_process.BEHIND


def _wiped(keys: LayerKeys, shape: LayerMaker) -> tuple[LayerKeys, LayerMaker]:
    """Return keys and shapes of a layer of the whole rig that shows two variants in a wipe."""

    def both(request: ViewRequest) -> dict[str, Hashable]:
        other = keys(request.of_other).get(WHOLE_RIG) if request.is_wiped else None
        return keys(request) if other is None else {**keys(request), OTHER_RIG: other}

    def either(
        request: ViewRequest, cache: LayerCache, name: str
    ) -> graphics.LayerShape | ShapeSteps:
        return shape(request.of_other if name == OTHER_RIG else request, cache, WHOLE_RIG)

    return both, either


def _rig_keys(*settings: str, prior: bool = True) -> LayerKeys:
    """Return the keys of a layer of the whole rig that depends on these settings."""

    def keys(request: ViewRequest) -> dict[str, Hashable]:
        if not request.counted or (prior and request.prior is None):
            return {}
        who = tuple(each.key for each in request.counted)
        chosen = tuple(getattr(request.view, each) for each in settings)
        return {WHOLE_RIG: (who, request.body_key, request.prior_key if prior else None, chosen)}

    return keys


def _counted_rig(request: ViewRequest) -> pe.Rig:
    return pe.Rig([each.sensor for each in request.counted])


def _ground_keys(request: ViewRequest) -> dict[str, Hashable]:
    settings: tuple[str, ...] = ("ground_quantity", "ground_height", "ground_opacity")
    settings += ("ground_range", "ground_fits")
    keys = _rig_keys(*settings)(request)
    scored = ground_layers.scored_map(request)
    compared = ground_layers.compared_key(request)
    more = id(scored), compared, request.is_wiped
    return {name: (key, more) for name, key in keys.items()}


def _ground(request: ViewRequest, cache: LayerCache, _name: str) -> graphics.LayerShape:
    return ground_layers.ground_map(request, cache)


def _blind(request: ViewRequest, cache: LayerCache, _name: str) -> graphics.LayerShape:
    height = request.view.blind_height_m
    found = cache.sight(request).blind(_counted_rig(request), height, within=BLIND_WITHIN_M)
    body = None if request.vehicle is None else request.vehicle.bounds
    return ground_layers.blind_ground(found, body, height)


def _birds_eye_keys(request: ViewRequest) -> dict[str, Hashable]:
    """Return the key of the plate, by cameras alone."""
    models = ((each, each.sensor.model) for each in request.counted)
    cameras = tuple(e for e, model in models if kinds.kind_of(model).pixels_per_radian(model))
    return _rig_keys("birds_eye_within")(replace(request, sensors=cameras))


def _birds_eye(request: ViewRequest, cache: LayerCache, _name: str) -> graphics.LayerShape:
    rig = _counted_rig(request)
    within = request.view.birds_eye_within
    return birds_eye(cache.sight(request).surround_view(rig, within))


def _reach_keys(request: ViewRequest) -> dict[str, Hashable]:
    keys = _rig_keys("reach_class", "reach_of")(request)
    chosen = tuple(each.sensor.name for each in request.counted if each.selected)
    return {name: (key, chosen) for name, key in keys.items()}


def _reach(request: ViewRequest, cache: LayerCache, _name: str) -> graphics.LayerShape:
    view = request.view
    assert request.prior is not None  # the layer has no key without one
    known = request.prior.class_names
    of = view.reach_class if view.reach_class in known else known[0]
    found = cache.sight(request).reach(
        _counted_rig(request), of, ap=ground_layers.REACH_AP, bearings=ground_layers.BEARINGS
    )
    whole = ground_layers.reach_of_rig(found)
    if view.reach_of == RIG:
        return whole
    everyone = view.reach_of == ALL
    named = {e.sensor.name: e.color for e in request.counted if everyone or e.selected}
    alone = ground_layers.reach_of_sensors(found, named)
    keys = [shape.legend for shape in (whole, alone) if shape.legend is not None]
    legend = graphics.ColorKey(keys[0].title, classes=tuple(c for k in keys for c in k.classes))
    return graphics.LayerShape(
        graphics.Primitives.joined([alone.lines, whole.lines]), labels=whole.labels, legend=legend
    )


def _beam_keys(request: ViewRequest) -> dict[str, Hashable]:
    view = request.view
    shown = request.of_beams()
    budget = graphics.beam_budget([each.sensor for each in shown], view.beam_limit)
    chosen = view.channels, view.beam_colors, view.rings, view.beam_length
    chosen_key = *chosen, budget
    return {each.sensor.name: (each.key, request.body_key, chosen_key) for each in shown}


def _beams(request: ViewRequest, cache: LayerCache, name: str) -> graphics.LayerShape:
    view = request.view
    shown = request.of_beams()
    of = next(each for each in shown if each.sensor.name == name)
    budget = graphics.beam_budget([each.sensor for each in shown], view.beam_limit)
    choice = graphics.BeamChoice(budget, graphics.ChannelMode(view.channels))
    found = cache.cast(request, of)
    beams = graphics.shown_beams(found, choice)
    colors = _beam_colors(of, view, beams.channel, beams.occluded)
    around = None if request.vehicle is None else request.vehicle.bounds
    parts = [graphics.free_lines(of.sensor, beams, view.beam_length, colors, around=around)]
    if view.rings:
        rows = graphics.channels_of(cast(pe.Lidar, of.sensor.model), choice)
        whole = _beam_colors(of, view, rows, np.zeros(len(rows), bool))
        whole[:, 3] = RING_ALPHA
        parts.append(graphics.ground_rings(found, rows, whole))
    occluded = graphics.occluded_lines(of.sensor, beams, colors)
    ghosts = graphics.Primitives.of(
        occluded.points, occluded.colors * [1.0, 1.0, 1.0, OCCLUDED_ALPHA]
    )
    lines = graphics.Primitives.joined([*parts, occluded])
    return graphics.LayerShape(lines=lines, through=ghosts, legend=_beam_legend(view))


def _beam_colors(
    of: SceneSensor, view: ViewSettings, channel: NDArray[np.int64], occluded: NDArray[np.bool_]
) -> NDArray[np.float32]:
    """(N, 4) colours of beams of these channels."""
    by_sensor = view.beam_colors == BY_SENSOR
    palette = graphics.sensor_palette(of.color) if by_sensor else graphics.VIEWPORT
    free, hit = (np.asarray(c, np.float32) for c in (palette.free, palette.occluded))
    colors = np.where(occluded[:, None], hit, free)
    if view.beam_colors == BY_CHANNEL:
        elevations = cast(pe.Lidar, of.sensor.model).elevations
        rank = np.argsort(np.argsort(elevations, kind="stable"))
        colors[:, :3] = graphics.on_scale(rank[channel] / max(len(rank) - 1, 1), graphics.VIRIDIS)
    return colors


def _beam_legend(view: ViewSettings) -> graphics.ColorKey:
    if view.beam_colors == BY_CHANNEL:
        row = graphics.on_scale(np.linspace(0.0, 1.0, graphics.SWATCHES), graphics.VIRIDIS)
        swatches = tuple((float(red), float(green), float(blue), 1.0) for red, green, blue in row)
        return graphics.ColorKey("Channel", swatches, ("lowest", "highest"))
    palette = graphics.VIEWPORT
    occluded = (graphics.with_alpha(palette.occluded, 1.0), "occluded by the vehicle")
    if view.beam_colors == BY_SENSOR:  # free beams have the colours of the labels
        return graphics.ColorKey("Beams", classes=(occluded,))
    return graphics.ColorKey(
        "Beams", classes=((graphics.with_alpha(palette.free, 1.0), "free"), occluded)
    )


def _heat_keys(request: ViewRequest) -> dict[str, Hashable]:
    who = tuple(each.key for each in request.of_beams())
    return {WHOLE_RIG: (who, request.body_key)} if who and request.vehicle is not None else {}


def _heat(request: ViewRequest, cache: LayerCache, _name: str) -> graphics.LayerShape:
    found = [cache.cast(request, each) for each in request.of_beams()]
    body = cache.body(request)
    assert body is not None  # the layer has no key without one
    return heatmap.hit_density(found, body.triangles)


def _view_keys(request: ViewRequest) -> dict[str, Hashable]:
    view = request.view
    shown = [e for e in request.sensors if e.drawn and not graphics.drawing_of(e.sensor.kind).beams]
    return {e.sensor.name: (e.key, e.selected, view.footprints, view.view_range) for e in shown}


def _views(request: ViewRequest, _cache: LayerCache, name: str) -> graphics.LayerShape:
    of = next(each for each in request.sensors if each.sensor.name == name)
    drawing = graphics.drawing_of(of.sensor.kind)
    palette = graphics.sensor_palette(of.color)
    lines, faces = (
        [draw(of.sensor, FRUSTUM_M, palette)] for draw in (drawing.lines, drawing.faces)
    )
    if drawing.footprint is not None and request.view.footprints:
        outline = drawing.footprint(of.sensor, request.view.view_range)
        lines.append(graphics.footprint_lines(outline, palette.camera))
        faces.append(graphics.footprint_faces(outline, palette.camera_face))
    shown = graphics.Primitives.joined(lines)
    filled = graphics.Primitives.joined(faces)
    for part in (shown, filled):
        part.colors[:, 3] *= 1.0 if of.selected else UNSELECTED_ALPHA
    return graphics.LayerShape(shown, filled)


def _label_keys(request: ViewRequest) -> dict[str, Hashable]:
    return {e.sensor.name: (e.key, e.selected) for e in request.sensors if e.drawn}


def _label(request: ViewRequest, _cache: LayerCache, name: str) -> graphics.LayerShape:
    of = next(each for each in request.sensors if each.sensor.name == name)
    color = graphics.with_alpha(of.color, 1.0)
    return graphics.LayerShape(
        labels=(graphics.Tag(name, of.sensor.pose.position, color, strong=of.selected),)
    )


def _ghost_keys(request: ViewRequest) -> dict[str, Hashable]:
    if not request.ghosts:
        return {}
    others = tuple((s.name, id(s.model), s.pose, s.group, s.curve) for s in request.ghosts)
    here = tuple((each.sensor.name, each.sensor.pose) for each in request.counted)
    reach_too = "reach" in request.view.layers and request.prior and not request.is_wiped
    reached = (request.body_key, request.prior_key, request.view.reach_class) if reach_too else None
    return {WHOLE_RIG: (others, here, request.ghosts_name, request.ghosts_title, reached)}


def _ghosts(request: ViewRequest, cache: LayerCache, _name: str) -> graphics.LayerShape:
    here = [e.sensor for e in request.counted]
    of = request.ghosts_title or GHOST_TITLE
    shape = ghost_sensors(request.ghosts, here, request.ghosts_name, of)
    if request.ghosts_title:
        return shape
    if "reach" not in request.view.layers or request.prior is None or request.is_wiped:
        return shape
    rig = pe.Rig(request.ghosts)
    known = request.prior.class_names
    of = request.view.reach_class if request.view.reach_class in known else known[0]
    line = ground_layers.rig_reach(
        cache.sight(request), rig, of, GHOST_PALETTE, name=request.ghosts_name
    )
    return replace(shape, lines=line.lines)


def _place_keys(request: ViewRequest) -> dict[str, Hashable]:
    place = request.place
    if place is None:
        return {}
    told = tuple((s.name, s.reason, s.m) for s in place.sensors)
    here = tuple((each.sensor.name, each.sensor.pose) for each in request.counted)
    return {WHOLE_RIG: (place.center, place.ap, told, here)}


def _place(request: ViewRequest, _cache: LayerCache, _name: str) -> graphics.LayerShape:
    assert request.place is not None  # the layer has no key without one
    return location_mark(request.place, [each.sensor for each in request.counted])


def _where_keys(request: ViewRequest) -> dict[str, Hashable]:
    found = request.where
    if found is None:
        return {}
    here = tuple((each.sensor.name, each.sensor.pose) for each in request.counted)
    return {WHOLE_RIG: (found, here)}


def _where(request: ViewRequest, _cache: LayerCache, _name: str) -> graphics.LayerShape:
    assert request.where is not None  # the layer has no key without one
    return place_colors(request.where, [each.sensor for each in request.counted])


def _region_keys(request: ViewRequest) -> dict[str, Hashable]:
    found = request.region
    if found is None:
        return {}
    here = tuple((each.sensor.name, each.sensor.pose) for each in request.counted)
    return {WHOLE_RIG: (found, request.view.region_loss, here)}


def _region(request: ViewRequest, _cache: LayerCache, _name: str) -> graphics.LayerShape:
    found = request.region
    assert found is not None  # the layer has no key without one
    if request.view.region_loss > 0.0:
        found = found.allowing(request.view.region_loss)
    return region_patch(found, [each.sensor for each in request.counted])


def _steepest_keys(request: ViewRequest) -> dict[str, Hashable]:
    return {} if request.steered is None else {WHOLE_RIG: request.steered.key}


def _steepest(request: ViewRequest, cache: LayerCache, _name: str) -> ShapeSteps:
    """Pause after each score; return the arrow, while something moves without turns and ghost."""
    steered = request.steered
    assert steered is not None  # the layer has no key without one
    study = steered.study
    places = advice.places_of(study, steered.name, anywhere=True, surfaces=cache.surfaces(request))
    samples = MOVED_SAMPLES if request.moving else IDLE_SAMPLES
    own = cache.evaluator(request, samples, lambda: study.evaluator(samples, 1))
    screen = None
    if not request.moving:
        screen = cache.evaluator(request, "screen", lambda: advice.screen_of(study, 1))
    found = yield from advice.steepest_steps(
        places, own, with_turns=not request.moving, screen=screen
    )
    return way_arrow(found, study.rig[steered.name])


def _requirement_keys(request: ViewRequest) -> dict[str, Hashable]:
    if not request.requirements:
        return {}
    chosen = request.requirements_key, request.requirement, request.reference
    keys = _rig_keys(prior=False)(request)
    return {name: (key, request.prior_key, chosen) for name, key in keys.items()}


def _requirements(request: ViewRequest, cache: LayerCache, _name: str) -> ShapeSteps:
    """Pause after each step of the check; the zones are there before the margins."""
    checker, unplaced = cache.checker(request)

    def zones_of(found: list[requirements.Verdict]) -> graphics.LayerShape:
        before = cache.met_before(request, found)
        return requirement_zones(found, request.requirement, before, unplaced)

    early: list[requirements.Verdict] = []
    verdicts: list[requirements.Verdict] = []
    is_told = False
    steps = checker.steps(_counted_rig(request), preview=request.moving, early=not request.moving)
    for step in steps:
        if step.verdict is not None:
            (early if step.is_early else verdicts).append(step.verdict)
        is_early = bool(early) and not (step.is_early or is_told)
        is_told = is_told or is_early
        yield zones_of(early) if is_early else None
    return zones_of(verdicts)


def _scenario_keys(request: ViewRequest) -> dict[str, Hashable]:
    if request.scenario is None:
        return {}
    rule = request.confirmation, request.rates, request.prior_key
    chosen = request.scenario, request.rate_hz, rule
    return {name: (key, chosen) for name, key in _rig_keys(prior=False)(request).items()}


def _scenario(request: ViewRequest, _cache: LayerCache, _name: str) -> graphics.LayerShape:
    rig = _counted_rig(request)
    vehicle = request.vehicle
    assert request.scenario is not None  # the layer has no key without one
    driven = motion.drive_by(
        request.scenario,
        rig,
        vehicle,
        request.model,
        confirmation=request.confirmation,
        rates=dict(request.rates),
    )
    return graphics.moving_shape(driven, rig, vehicle, request.rate_hz)


def _mount_keys(request: ViewRequest) -> dict[str, Hashable]:
    if not request.mounts and not request.boxes:
        return {}
    return {WHOLE_RIG: (tuple((each.key, each.strong) for each in request.mounts), request.boxes)}


def _mounts(request: ViewRequest, _cache: LayerCache, _name: str) -> graphics.LayerShape:
    return regions.mount_regions(request.mounts, request.boxes)


def _focus_keys(request: ViewRequest) -> dict[str, Hashable]:
    return (
        {WHOLE_RIG: (request.focus, request.space)}
        if request.focus and request.space is not None
        else {}
    )


def _focus(request: ViewRequest, _cache: LayerCache, _name: str) -> graphics.LayerShape:
    assert request.space is not None  # the layer has no key without one
    return regions.focus_regions(request.focus, request.space)


def _axle_keys(request: ViewRequest) -> dict[str, Hashable]:
    return {} if request.reference is None else {WHOLE_RIG: (request.reference, request.body_key)}


def _axles(request: ViewRequest, _cache: LayerCache, _name: str) -> graphics.LayerShape:
    half = None if request.vehicle is None else float(request.vehicle.bounds[1][1])
    assert request.reference is not None  # the layer has no key without one
    return axles(request.reference, half)


def _front_keys(request: ViewRequest) -> dict[str, Hashable]:
    """Return the arrow's key while there is a vehicle and no sensor yet."""
    return {} if request.sensors or request.vehicle is None else {WHOLE_RIG: request.body_key}


def _front(request: ViewRequest, _cache: LayerCache, _name: str) -> graphics.LayerShape:
    assert request.vehicle is not None  # the layer has no key without one
    return front_arrow(request.vehicle)


LAYERS = (
    Layer("ground", "Ground Map", *_wiped(_ground_keys, _ground), rough=True, on_ground=True),
    Layer("blind", "Blind Ground", *_wiped(_rig_keys("blind_height"), _blind), 1.6, **ZONES),
    Layer("reach", "Reach", *_wiped(_reach_keys, _reach), 2.2, **ZONES),
    Layer(
        "requirements",
        "Requirements",
        _requirement_keys,
        _requirements,
        line_px=1.6,
        rough=True,
        **ZONES,
    ),
    Layer("where", "Where?", _where_keys, _where, on_ground=True),
    Layer("region", "Free Region", _region_keys, _region, line_px=2.2, edged=True),
    Layer(
        "steepest",
        "Best Way",
        _steepest_keys,
        _steepest,
        line_px=2.2,
        rough=True,
        edged=True,
        lane=STEERING,
    ),
    Layer("mounts", "Mounts", _mount_keys, _mounts, line_px=1.4, edged=True),
    Layer("focus", "Focus", _focus_keys, _focus, line_px=1.4, edged=True),
    Layer("frustums", "Camera Views", _view_keys, _views),
    Layer("beams", "Beams", _beam_keys, _beams, rough=True),
    Layer("heat", "Occluded Beams", _heat_keys, _heat, rough=True),
    Layer("scenario", "Drive-by", _scenario_keys, _scenario, line_px=1.8, edged=True),
    Layer("axles", "Axles", _axle_keys, _axles, line_px=1.6, edged=True),
    Layer("front", "Front", _front_keys, _front, line_px=2.2, edged=True),
    Layer("ghosts", "Other Variant", _ghost_keys, _ghosts, line_px=1.6, edged=True),
    Layer("place", "Queried Location", _place_keys, _place, line_px=1.8, edged=True),
    Layer(BIRDS_EYE, "Bird's-Eye View", _birds_eye_keys, _birds_eye),
    Layer("labels", "Names", _label_keys, _label),
)
assert all(a.name != b.name for a, b in pairwise(LAYERS))
