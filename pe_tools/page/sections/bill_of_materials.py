"""The bill of materials: sensor models, their number and their price.

Prices come from the study's choices (``[[choice]]``); the catalogue has none.
"""

from __future__ import annotations

from typing import Any

import pe_core as pe
from pe_core import sensors as kinds

from ..markup import macros
from ..report_context import ReportContext

NO_PRICE = "no price"
ModelPrice = tuple[str, float | None]
"""A model's name and its unit price; None if the study gives no price."""


def price_of(study: pe.Study, sensor: pe.Sensor) -> float | None:
    """Return the price of a sensor in the study's currency; None if the study gives none.

    A choice that names the sensor has precedence over other choices that offer its model.
    """
    choices = study.selection.choices
    naming = [choice for choice in choices if sensor.name in (choice.sensors or ())]
    for choice in (*naming, *choices):
        for option in choice.options:
            if option.model.name == sensor.model.name:
                return option.price
    return None


def price_text(price: float, currency: str) -> str:
    """Return a price with its currency: "12,500 EUR", "99.50"."""
    amount = f"{price:,.0f}" if float(price).is_integer() else f"{price:,.2f}"
    return f"{amount} {currency}".strip()


def currency_of(study: pe.Study) -> str:
    """Return the currency of a study's prices; empty if it gives none."""
    return study.selection.currency or ""


def bill_of_materials(contexts: tuple[ReportContext, ...]) -> dict[str, Any]:
    """Return the bill of materials of a study, or of several in one table."""
    bold, study_name = macros().bold, macros().study_name
    by_model = [_sensors_by_model(context) for context in contexts]
    models = dict.fromkeys(key for own in by_model for key in own)
    currency = currency_of(contexts[0].study)
    counts = [str(len(tuple(context.rig))) for context in contexts]
    rows: list[list[str]]
    if len(contexts) == 1:
        caption = "Sensors"
        heads = ["Sensor model", "Kind", "Sensors", "Count", "Unit price", "Sum"]
        rows = [
            [
                *(model, kinds.kind_of(sensors[0]).label, ", ".join(s.name for s in sensors)),
                str(len(sensors)),
                *(_priced(price, currency), _priced(price, currency, len(sensors))),
            ]
            for (model, price), sensors in by_model[0].items()
        ]
        rows.append([bold("All sensors"), "", "", bold(counts[0]), "", bold(_total(contexts[0]))])
    else:
        caption = "Sensors of each study"
        heads = ["Sensor model", "Unit price", *map(study_name, contexts)]
        rows = [
            [
                key[0],
                _priced(key[1], currency),
                *(str(len(o.get(key, ())) or "–") for o in by_model),
            ]
            for key in models
        ]
        rows.append([bold("Count"), "", *map(bold, counts)])
        rows.append([bold("Sum"), "", *(bold(_total(context)) for context in contexts)])
    no_price = list(dict.fromkeys(model for model, price in models if price is None))
    return {"caption": caption, "heads": heads, "rows": rows, "no_price": no_price}


def _sensors_by_model(context: ReportContext) -> dict[ModelPrice, list[pe.Sensor]]:
    """Return the sensors of each model, in the rig's order."""
    by_model: dict[ModelPrice, list[pe.Sensor]] = {}
    for sensor in context.rig:
        key = sensor.model.name, price_of(context.study, sensor)
        by_model.setdefault(key, []).append(sensor)
    return by_model


def _priced(price: float | None, currency: str, count: int = 1) -> str:
    return NO_PRICE if price is None else price_text(price * count, currency)


def _total(context: ReportContext) -> str:
    """Return the price of all sensors; "at least" the known part if some prices are missing."""
    prices = [price_of(context.study, sensor) for sensor in context.rig]
    known = [price for price in prices if price is not None]
    if not known:
        return NO_PRICE
    total = price_text(sum(known), currency_of(context.study))
    return total if len(known) == len(prices) else f"at least {total}"
