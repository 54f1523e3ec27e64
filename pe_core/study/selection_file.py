"""Choices of sensors and limits on them: their tables in the study file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from ..errors import InputError
from ..kinds import KINDS
from ..scene.sensors import SensorModel
from ..search import Choice, Option, Selection
from ..text.tables import Table

T = TypeVar("T")
Read = Callable[[Table], SensorModel]


def read_selection(table: Table, model: Read) -> Selection:
    """Return what `[[choice]]` and `[selection]` of a study say.

    Parameters
    ----------
    table : Table
        Of the whole study.
    model : callable
        Reads the model of an option from its table.
    """
    choices = [_read_choice(each, model) for each in table.tables("choice")]
    own = table.table("selection")
    price, sensors = own.number("max_price", None), own.whole("max_sensors", None)
    kinds, currency = own.table("max_of_kind"), own.text("currency", "")
    counts = {kind: kinds.whole(kind, None) for kind in KINDS}
    kinds.finish()
    own.finish()
    said = {kind: count for kind, count in counts.items() if count is not None}
    return _made(own, lambda: Selection(choices, price, sensors, said, currency))


def selection_tables(
    selection: Selection, model: Callable[[SensorModel], str | dict[str, Any]]
) -> dict[str, Any]:
    """Return the tables that `read_selection` reads; none where there is nothing to choose."""
    own = {
        "max_price": selection.max_price,
        "max_sensors": selection.max_sensors,
        "max_of_kind": dict(selection.max_of_kind) or None,
        "currency": selection.currency or None,
    }
    choices = [_choice_table(choice, model) for choice in selection.choices]
    said = any(value is not None for value in own.values())
    return {"choice": choices or None, "selection": own if said else None}


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
    """Make something of a table's values; what is wrong is said of the table."""
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
