"""Reads a scene into a request: the only part of the overlay that reads Blender's data."""

import contextlib
import time
from collections.abc import Hashable
from dataclasses import replace
from typing import Any, NamedTuple

import bpy
import numpy as np

from .. import document
from ..caches import sensor_cache, vehicle_cache
from ..choices import LimitBox
from ..engine import graphics, pe, studies
from ..live import BEFORE_SEARCH, live_state, shown_score
from ..processes.engine_calls import rig_key
from ..queries import location_query, where_map
from ..view import best_so_far
from ..view.view_settings import MIN_LENGTH_M, ViewSettings
from .annotations import WOULD_FIX
from .layers import LAYERS
from .request import MountFaces, SceneSensor, SteeredSensor, ViewRequest

BEST_SO_FAR = "best so far"
SLOW_S = 0.05
"""A vehicle that took longer to read is not read again while it is moving."""


class ScoringInputs(NamedTuple):
    """Everything that scores a scene's rigs; `key` identifies it."""

    prior: pe.Prior | None
    space: pe.PerceptionSpace | None
    model: pe.PerceptionModel | None
    key: Hashable
    targets: pe.TargetRule | None = None


class SnapshotReader:
    """Caches expensive data by plain keys; it never holds a Blender object."""

    def __init__(self) -> None:
        self._inputs: dict[str, ScoringInputs] = {}
        self._bodies: dict[str, vehicle_cache.CachedVehicle] = {}
        self._faces: dict[str, dict[Hashable, np.ndarray]] = {}
        self._steered: dict[str, SteeredSensor] = {}
        self._took_s = 0.0

    def clear(self) -> None:
        """Drop everything: another file is opened."""
        for cached in (self._inputs, self._bodies, self._faces, self._steered):
            cached.clear()
        self._took_s = 0.0

    def request(
        self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, moving: bool = False
    ) -> ViewRequest:
        """Return the request of a scene's layers."""
        sensors = _sensors(scene, depsgraph)
        vehicle, body_key = self._vehicle(scene, depsgraph, moving)
        inputs = self._inputs_by(scene)
        others, name, title = _ghosts(scene)
        compared, compared_name = _compared(scene, sensors)
        answer = location_query.answer(scene)
        mounts = self._mounts(scene, depsgraph, sensors, vehicle, body_key=body_key)
        return ViewRequest(
            sensors,
            vehicle,
            body_key,
            inputs.prior,
            prior_key=inputs.key,
            view=view_of(scene),
            moving=moving,
            scored=_scored(scene, sensors, inputs.space),
            space=inputs.space,
            model=inputs.model,
            targets=inputs.targets,
            ghosts=others,
            ghosts_name=name,
            ghosts_title=title,
            place=None if answer is None else answer.place,
            mounts=mounts,
            boxes=_boxes(scene, sensors, vehicle, mounts),
            compared=compared,
            compared_name=compared_name,
            has_result=scene.perception_entropy.has_result,
            focus=document.focus_regions(scene),
            reference=_reference(scene),
            where=where_map.maps.get(scene.name),
            region=where_map.regions.get(scene.name),
            steered=self._steered_sensor(scene, depsgraph, sensors, vehicle, moving=moving),
            **(_requirements(scene) | _scenario(scene)),
        )

    def _mounts(
        self,
        scene: bpy.types.Scene,
        depsgraph: bpy.types.Depsgraph,
        sensors: tuple[SceneSensor, ...],
        vehicle: pe.Vehicle | None,
        body_key: Hashable,
    ) -> tuple[MountFaces, ...]:
        """Return the surfaces of the mounts; read again when they or the vehicle changed."""
        if vehicle is None:
            return ()
        names = [each.sensor.name for each in sensors if each.selected]
        chosen = {scene.objects[n].perception_entropy.mount for n in names if n in scene.objects}
        known = self._faces.get(scene.name, {})
        shown = []
        found: dict[Hashable, np.ndarray] = {}
        for row in scene.perception_entropy.mounts:
            if (said := document.mount_key(row)) is None:
                continue
            key = said, body_key
            faces = known.get(key)
            if faces is None:
                faces = document.mount_faces(scene, depsgraph, row, vehicle)
            found[key] = faces
            if len(faces):
                shown.append(MountFaces(row.name, key, faces, row.name in chosen))
        self._faces[scene.name] = found
        return tuple(shown)

    def _inputs_by(self, scene: bpy.types.Scene) -> ScoringInputs:
        """Return prior, space and AP curves; no prior where a setting is wrong: a score says so."""
        settings = scene.perception_entropy
        space = None
        try:
            space = document.document_of(settings, "space").space
            scored = document.document_of(settings, *document.SCORED_PARTS)
            model = scored.perception
            targets = scored.targets
            key = document.prior_key(scene), space, model, targets
            known = self._inputs.get(scene.name)
            if known is None or known.key != key:
                known = ScoringInputs(
                    document.prior_from_scene(scene), space, model, key=key, targets=targets
                )
        except pe.InputError as error:
            known = ScoringInputs(None, space, None, str(error))
        self._inputs[scene.name] = known
        return known

    def _steered_sensor(
        self,
        scene: bpy.types.Scene,
        depsgraph: bpy.types.Depsgraph,
        sensors: tuple[SceneSensor, ...],
        vehicle: pe.Vehicle | None,
        *,
        moving: bool,
    ) -> SteeredSensor | None:
        """Return the active sensor, to show its best way. While something moves it is as the last
        live score has it, in the study as it was when the scene was idle: a score that is known is
        of a moment ago, and the next move does not wait."""
        known = self._steered.pop(scene.name, None)
        view = scene.perception_entropy.view
        active = depsgraph.view_layer.objects.active
        names = [each.sensor.name for each in sensors if each.selected and each.counted]
        if not view.show_steepest or active is None or active.name not in names:
            return None
        if known is not None and known.name != active.name:
            known = None
        inputs = self._inputs[scene.name]
        if moving and known is not None:
            study = known.study.with_rig(_scored_rig(scene, known.study.rig))
        else:
            try:
                objects = sensor_cache.sensors(scene)
                study = document.study_from_scene(scene, depsgraph, vehicle, objects)
            except pe.InputError:
                return None
            study = replace(study, prior=inputs.prior or study.prior)
        own = study.search
        where = own.mounting, own.free.get(active.name), own.limits.get(active.name), study.limits
        key = active.name, rig_key(study.rig), self._bodies[scene.name].key, inputs.key, where
        self._steered[scene.name] = SteeredSensor(active.name, study, key)
        return self._steered[scene.name]

    def _vehicle(
        self, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, moving: bool
    ) -> vehicle_cache.CachedVehicle:
        known = self._bodies.get(scene.name)
        if known is not None and moving and self._took_s > SLOW_S:
            return known
        start = time.perf_counter()
        found = self._bodies[scene.name] = vehicle_cache.shared.read(scene, depsgraph)
        if known is None or found.key != known.key:
            self._took_s = time.perf_counter() - start
        return found


def _scored_rig(scene: bpy.types.Scene, known: pe.Rig) -> pe.Rig:
    """Return the rig of the last live score, with the same sensors as one that is known; that one
    without a score of them."""
    live = scene.perception_entropy.live.on
    score = live_state(scene.name).score if live else None
    if score is None or {each.name for each in score.request.rig} != {each.name for each in known}:
        return known
    return score.request.rig


def view_of(scene: bpy.types.Scene) -> ViewSettings:
    """Return the view settings as plain values."""
    settings = scene.perception_entropy
    values = {name: getattr(settings.view, name) for name in studies.settings_of(ViewSettings)}
    on = [each.name for each in LAYERS if settings.show_overlay and values[f"show_{each.name}"]]
    length_m = max(MIN_LENGTH_M, values.pop("beam_length"))  # also where it is not a number
    more = {"layers": frozenset(on), "beam_length": length_m}
    return ViewSettings(**values, **more)


def _sensors(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> tuple[SceneSensor, ...]:
    """Return the possible sensors; a score reports what is wrong with others."""
    layer = depsgraph.view_layer
    possible = []
    active = layer.objects.active
    for obj in sensor_cache.sensors(scene):
        with contextlib.suppress(pe.InputError):
            possible.append((obj, document.sensor_from_object(obj, depsgraph)))
    colors = graphics.sensor_colors(sensor for _, sensor in possible)
    found = []
    for obj, sensor in possible:
        selected = obj == active or obj.select_get(view_layer=layer)
        drawn = obj.perception_entropy.show
        counted = obj.visible_get(view_layer=layer)
        found.append(SceneSensor(sensor, colors[sensor.name], selected, drawn, counted=counted))
    return tuple(found)


def _boxes(
    scene: bpy.types.Scene,
    sensors: tuple[SceneSensor, ...],
    vehicle: pe.Vehicle | None,
    mounts: tuple[MountFaces, ...],
) -> tuple[LimitBox, ...]:
    """Return no-go areas, and bounds of selected sensors; a search reports what is wrong there."""
    found: list[LimitBox] = []
    faces = {each.name: each.triangles for each in mounts}
    with contextlib.suppress(pe.InputError):
        found += document.no_go_boxes(scene)
    for each in sensors:
        if each.selected and (obj := scene.objects.get(each.sensor.name)) is not None:
            with contextlib.suppress(pe.InputError):
                around = faces.get(obj.perception_entropy.mount)
                box = document.bounds_box(obj, each.sensor, vehicle, around)
                found += [] if box is None else [box]
    return tuple(found)


def _scored(
    scene: bpy.types.Scene, sensors: tuple[SceneSensor, ...], space: pe.PerceptionSpace | None
) -> pe.GroundMap | None:
    """Return the last score's ground map; None where it is not that of what is shown."""
    finished = live_state(scene.name).finished
    if finished is None or scene.perception_entropy.result_stale or finished.study.space != space:
        return None
    if document.shown_state(scene):  # the score is of the vehicle as drawn
        return None
    now = {(e.sensor.name, e.sensor.model, e.sensor.pose) for e in sensors if e.counted}
    then = {(each.name, each.model, each.pose) for each in finished.study.rig}
    return finished.score.ground_map if now == then else None


def _ghosts(scene: bpy.types.Scene) -> tuple[tuple[pe.Sensor, ...], str, str]:
    """Return sensors that are shown beside the scene's own, their name, and what they are: the best
    placement of a running search so far, suggestions, a built rig, otherwise another variant."""
    if best := best_so_far.best(scene.name):
        return best, BEST_SO_FAR, "Search"
    if (offers := where_map.offers.get(scene.name)) and offers.found:
        new = tuple(each.rig[name] for each in offers.found for name in each.moved)
        return new, "moved, or added", WOULD_FIX
    if (compared := where_map.built.get(scene.name)) is not None:
        pairs = compared.pairing.pairs
        return tuple(each.designed.moved(each.built.pose) for each in pairs), "calibration", "Built"
    return *_variant(scene, scene.perception_entropy.view.ghost_key), ""


def _compared(
    scene: bpy.types.Scene, sensors: tuple[SceneSensor, ...]
) -> tuple[tuple[pe.Sensor, ...], str]:
    """Return the sensors that the difference map compares with, and their name: the baseline of
    what is shown; without it, the variant that the live score is set to."""
    settings = scene.perception_entropy
    if not settings.view.ground_difference:
        return (), ""
    shown = shown_score(scene)
    baseline = None if shown is None else shown.baseline
    if baseline is not None and baseline.rig is not None:
        return tuple(baseline.rig), baseline.label
    if baseline is not None and baseline.label == BEFORE_SEARCH:
        poses = {
            name: pe.Pose.from_degrees(each["position"], each["rotation"])
            for name, each in settings.result.placed_before.items()
        }
        now = [each.sensor for each in sensors if each.sensor.name in poses]
        return tuple(each.moved(poses[each.name]) for each in now), baseline.label
    return _variant(scene, settings.live.against)


def _variant(scene: bpy.types.Scene, key: int) -> tuple[tuple[pe.Sensor, ...], str]:
    """Return the sensors of the variant with a key, and its name; nothing without such a one."""
    settings = scene.perception_entropy
    for row in settings.variants if key else ():
        if row.key == key:
            with contextlib.suppress(pe.InputError):
                rig = document.rig_of(document.records_of(row), returns=settings.returns)
                return tuple(rig), row.name
    return (), ""


def _requirements(scene: bpy.types.Scene) -> dict[str, Any]:
    """Return the requirements of a scene; none where one is wrong: a check says what is."""
    settings = scene.perception_entropy
    rows = settings.requirements
    index = settings.requirement_index
    chosen = rows[index].name if index < len(rows) else ""
    try:
        found = document.requirements_of(settings)
    except pe.InputError:
        return {"requirement": chosen}
    key = document.requirements_key(settings)
    return {"requirements": found, "requirements_key": key, "requirement": chosen}


def _reference(scene: bpy.types.Scene) -> pe.Reference | None:
    """Return the positions of the axles; None where they are not known, or wrong."""
    with contextlib.suppress(pe.InputError):
        return document.document_of(scene.perception_entropy, "reference").reference
    return None


def _scenario(scene: bpy.types.Scene) -> dict[str, Any]:
    """Return the selected scenario of a scene; none where it is wrong: a check says what is."""
    settings = scene.perception_entropy
    if settings.scenario_index >= len(settings.scenarios):
        return {}
    try:
        found = document.scenario_of(settings.scenarios[settings.scenario_index])
        time = document.document_of(settings, "time").time
    except pe.InputError:
        return {}
    shown = {"scenario": found, "confirmation": time.confirmation}
    rates = tuple(time.frames.rates.items())
    return {**shown, "rates": rates, "rate_hz": document.frame_rate(scene)}
