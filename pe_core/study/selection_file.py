"""Choices of sensors and limits on them: their tables in the study file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from ..base.errors import InputError
from ..base.setting_file import read_settings, settings_table
from ..base.table_reader import Table
from ..scene.rig import SensorModel
from ..search import Choice, Option, Selection
from ..sensors import KINDS

T = TypeVar("T")
Read = Callable[[Table], SensorModel]


def read_selection(table: Table, model: Read) -> Selection:
    """Return the choices and limits of `[[choice]]` and `[selection]`.

    Parameters
    ----------
    table : Table
        Of the whole study.
    model : callable
        Reads the model of an option from its table.
    """
    choices = [_read_choice(each, model) for each in table.tables("choice")]
    own = table.table("selection")
    limits = read_settings(own, Selection)
    kinds, currency = own.table("max_of_kind"), own.text("currency", "")
    counts = {kind: kinds.whole(kind, None) for kind in KINDS}
    kinds.finish()
    own.finish()
    max_of_kind = {kind: count for kind, count in counts.items() if count is not None}
    return _made(
        own, lambda: Selection(choices, max_of_kind=max_of_kind, currency=currency, **limits)
    )


def selection_tables(
    selection: Selection, model: Callable[[SensorModel], str | dict[str, Any]]
) -> dict[str, Any]:
    """Return the tables that `read_selection` reads; None where there is nothing to choose."""
    own = {
        **settings_table(selection),
        "max_of_kind": dict(selection.max_of_kind) or None,
        "currency": selection.currency or None,
    }
    choices = [_choice_table(choice, model) for choice in selection.choices]
    has_limits = any(value is not None for value in own.values())
    return {"choice": choices or None, "selection": own if has_limits else None}


def _read_choice(table: Table, model: Read) -> Choice:
    if "sensor" in table and "sensors" in table:
        raise table.error("sensor, sensors", "one of the two", "both")
    sensors = (table.text("sensor"),) if "sensor" in table else table.texts("sensors", ())
    mount, optional = table.text("mount", None), table.raw("optional", False)
    options = [_read_option(each, model) for each in table.tables("option")]
    table.raw("sensor", None)  # a known name, whether present or not
    table.finish()
    return _made(table, lambda: Choice(options, sensors, mount, optional))


def _read_option(table: Table, model: Read) -> Option:
    chosen = _made(table, lambda: model(table))
    if "price" not in table:
        raise table.error("price", "what a sensor of this model costs", "nothing")
    price = table.number("price")
    table.finish()
    return _made(table, lambda: Option(chosen, price))


def _made(table: Table, make: Callable[[], T]) -> T:
    """Call `make`; its errors name the table."""
    try:
        return make()
    except InputError as error:
        if error.source == table.source:
            raise
        raise table.error(error.field, error.expected, error.found) from None


def _choice_table(
    choice: Choice, model: Callable[[SensorModel], str | dict[str, Any]]
) -> dict[str, Any]:
    named = {"sensor": choice.sensors[0]} if len(choice.sensors) == 1 else {}
    several = {"sensors": list(choice.sensors)} if len(choice.sensors) > 1 else {}
    return {
        **named,
        **several,
        "mount": choice.mount,
        "optional": choice.optional,
        "option": [{"model": model(o.model), "price": o.price} for o in choice.options],
    }
