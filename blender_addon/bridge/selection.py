"""The front of price against entropy, as variants of a scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import bpy

from ..engine import pe
from .placeable import check_placeable
from .records import Record, records_of_scene
from .variants import choose_variant, kept_variant, write_score

BEFORE = "Before choosing"
LONGEST_NAME = 60


def check_choosable(scene: bpy.types.Scene, study: pe.Study) -> None:
    """Complain about a scene in which nothing is to be chosen, or sensors cannot be placed.

    Raises
    ------
    InputError
        When no sensor has models to choose from, no design keeps to the limits, or something
        else holds a sensor that is to be moved.
    """
    if not study.selection.choices:
        expected = "a sensor with models to choose from (panel Sensor Choices)"
        raise pe.InputError("scene", "choices", expected, "none")
    try:
        study.designs()
    except pe.InputError as error:
        field = f"{error.source}: {error.field}"
        raise pe.InputError("scene", field, error.expected, error.found) from None
    if any(study.search.free.values()) or study.search.mounting.on:
        check_placeable(scene, study)


def keep_front(scene: bpy.types.Scene, found: pe.TradeOff, surroundings: str) -> None:
    """Keep each design of a front as a variant; what stands in the scene stays, as one, too."""
    now, settings = records_of_scene(scene), scene.perception_entropy
    began = kept_variant(scene, BEFORE, now).key
    settings.front.clear()
    for design in found.front:
        variant = kept_variant(scene, design.name[:LONGEST_NAME], _designed(now, design))
        if design.score is not None:
            write_score(variant, design.score, surroundings)
        variant.note = variant.note or _note(design, settings.currency)
        row = settings.front.add()
        row.name, row.key = design.name, variant.key
        row.price, row.entropy = design.price, design.entropy
    looked, all_of = len(found.designs) + len(found.refused), found.is_complete
    more = "all there are" if all_of else "of more"
    settings.front_told = f"{found.searched} searched of {looked} looked at, {more}"
    choose_variant(scene, began)


def _designed(now: Sequence[Record], design: pe.Design) -> tuple[Record, ...]:
    """Return the scene's sensors as a design has them; those that it leaves out are not there."""
    taken: Mapping[str, pe.Sensor] = {sensor.name: sensor for sensor in design.study.rig}
    gone = {name for name, model in design.models.items() if model is None}
    return tuple(
        _as_taken(record, taken[record.name]) if record.name in taken else record
        for record in now
        if record.name not in gone
    )


def _as_taken(record: Record, sensor: pe.Sensor) -> Record:
    model, fusion = sensor.model.name, sensor.fusion or ""
    return replace(record, model=model, fusion=fusion, pose=sensor.pose, curve=sensor.curve)


def _note(design: pe.Design, currency: str) -> str:
    return f"{design.price:,.10g} {currency}".strip()
