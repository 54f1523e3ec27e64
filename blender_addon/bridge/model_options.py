"""Models that may take the place of a scene's sensors, with prices: the choices of a study."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy

from ..engine import catalog, pe
from .scene_settings import values_of
from .sensor_records import ModelOption, SensorRecord


def selection_of(records: Sequence[SensorRecord], limits: pe.Selection) -> pe.Selection:
    """Return the choices of visible sensors with the scene's limits on all of them.

    Raises
    ------
    InputError
        When a model is not in the catalogue, is there twice, or has no price.
    """
    choices = [_choice(record) for record in records if record.visible and record.options]
    return replace(limits, choices=choices) if choices else pe.Selection()


def selection_limits(settings: bpy.types.PropertyGroup) -> pe.Selection:
    """Return a scene's limits on all sensors that are chosen, without the choices."""
    return pe.Selection(currency=settings.currency.strip(), **values_of(settings, pe.Selection))


def write_options(settings: bpy.types.PropertyGroup, record: SensorRecord) -> None:
    """Write the model options of a record to a sensor of the scene."""
    settings.options.clear()
    settings.may_be_left_out = record.may_be_left_out
    for option in record.options:
        row = settings.options.add()
        row.model, row.price = option.model, option.price


def _choice(record: SensorRecord) -> pe.Choice:
    try:
        options = [pe.Option(catalog.load(o.model), _price(o)) for o in record.options]
        return pe.Choice(options, [record.name], None, record.may_be_left_out)
    except pe.InputError as error:
        field = f"sensor {record.name!r}: {error.field}"
        raise pe.InputError("scene", field, error.expected, error.found) from None


def _price(option: ModelOption) -> float:
    if option.price <= 0.0:
        raise pe.InputError("choice", f"price of {option.model}", "a price above 0", option.price)
    return option.price
