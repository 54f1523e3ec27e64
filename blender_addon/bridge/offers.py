"""What a scene's sensors may be instead of what they are, at what price, for the engine."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ..engine import catalog, pe
from .typed import as_typed


def selection_of(
    settings: bpy.types.PropertyGroup, objects: Sequence[bpy.types.Object]
) -> pe.Selection:
    """Return the choices of a scene's sensors, and the limits on all of them.

    Raises
    ------
    InputError
        When a model is none, is there twice, or has no price.
    """
    choices = [_choice(obj) for obj in objects if obj.perception_entropy.options]
    if not choices:
        return pe.Selection()
    price, sensors = as_typed(settings.max_price) or None, settings.max_sensors or None
    return pe.Selection(choices, price, sensors, {}, settings.currency.strip())


def put_selection(scene: bpy.types.Scene, study: pe.Study) -> None:
    """Have a scene's sensors be offered what a study's are, and its limits be the study's.

    Sensors that choose together each get the models; limits by kind have no place in a scene.
    """
    settings, selection, on = scene.perception_entropy, study.selection, study.search.mounting.on
    settings.max_price, settings.max_sensors = (
        selection.max_price or 0.0,
        selection.max_sensors or 0,
    )
    settings.currency = selection.currency
    for sensor in study.rig:
        own = scene.objects[sensor.name].perception_entropy
        own.options.clear()
        own.may_be_left_out = False
        for choice in selection.choices:
            if sensor.name in choice.sensors or choice.mount == on.get(sensor.name, ""):
                _offer(own, choice)


def _offer(own: bpy.types.PropertyGroup, choice: pe.Choice) -> None:
    own.may_be_left_out = choice.optional
    for option in choice.options:
        row = own.options.add()
        row.model, row.price = option.model.name, option.price


def _choice(obj: bpy.types.Object) -> pe.Choice:
    own, who = obj.perception_entropy, f"sensor {obj.name!r}"
    try:
        options = [pe.Option(catalog.load(o.model), _price(o)) for o in own.options]
        return pe.Choice(options, [obj.name], None, own.may_be_left_out)
    except pe.InputError as error:
        field = f"{who}: {error.field}"
        raise pe.InputError("scene", field, error.expected, error.found) from None


def _price(option: bpy.types.PropertyGroup) -> float:
    price = as_typed(option.price)
    if price <= 0.0:
        raise pe.InputError("choice", f"price of {option.model}", "a price above 0", price)
    return price
