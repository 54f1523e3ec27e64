"""The bill of materials: sensor models, their number and their price.

Prices come from the study's choices (``[[choice]]``); the catalogue has none.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import pe_core as pe
from pe_core import sensors as kinds
from pe_core.base.errors import plural

from ..markup import Markup, escaped, joined, table
from ..report_context import ReportContext, Section

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


def bill_of_materials(contexts: tuple[ReportContext, ...]) -> Section:
    """Return the bill of materials of a study, or of several in one table."""
    inside = _single_table(contexts[0]) if len(contexts) == 1 else _joint_table(contexts)
    return Section("bill", "Bill of materials", f"{inside}{_price_note(contexts)}")


def _sensors_by_model(context: ReportContext) -> dict[ModelPrice, list[pe.Sensor]]:
    """Return the sensors of each model, in the rig's order."""
    by_model: dict[ModelPrice, list[pe.Sensor]] = {}
    for sensor in context.rig:
        key = sensor.model.name, price_of(context.study, sensor)
        by_model.setdefault(key, []).append(sensor)
    return by_model


def _single_table(context: ReportContext) -> str:
    heads = ("Sensor model", "Kind", "Sensors", "Count", "Unit price", "Sum")
    return table("Sensors", heads, _rows(context), css="bill")


def _rows(context: ReportContext) -> Iterator[list[str | Markup]]:
    currency = currency_of(context.study)
    for (model, price), sensors in _sensors_by_model(context).items():
        names = ", ".join(sensor.name for sensor in sensors)
        yield [
            *(model, kinds.kind_of(sensors[0]).label, names, str(len(sensors))),
            NO_PRICE if price is None else price_text(price, currency),
            NO_PRICE if price is None else price_text(price * len(sensors), currency),
        ]
    total = str(len(tuple(context.rig)))
    yield [_bold("All sensors"), "", "", _bold(total), "", _bold(_total(context))]


def _joint_table(contexts: Sequence[ReportContext]) -> str:
    models = dict.fromkeys(key for context in contexts for key in _sensors_by_model(context))
    heads: list[str | Markup] = ["Sensor model", "Unit price"]
    heads += [_study_name(context) for context in contexts]
    rows: list[list[str | Markup]] = []
    currency = currency_of(contexts[0].study)
    for key in models:
        model, price = key
        counts = [str(len(_sensors_by_model(c).get(key, ())) or "–") for c in contexts]
        rows.append([model, NO_PRICE if price is None else price_text(price, currency), *counts])
    rows.append([_bold("Count"), "", *(_bold(str(len(tuple(c.rig)))) for c in contexts)])
    rows.append([_bold("Sum"), "", *(_bold(_total(context)) for context in contexts)])
    return table("Sensors of each study", heads, rows)


def _total(context: ReportContext) -> str:
    """Return the price of all sensors; "at least" the known part if some prices are missing."""
    prices = [price_of(context.study, sensor) for sensor in context.rig]
    known = [price for price in prices if price is not None]
    if not known:
        return NO_PRICE
    total = price_text(sum(known), currency_of(context.study))
    return total if len(known) == len(prices) else f"at least {total}"


def _price_note(contexts: Sequence[ReportContext]) -> str:
    """Return a note on the source of prices, and on the models without a price."""
    models = list(
        dict.fromkeys(
            model
            for context in contexts
            for model, price in _sensors_by_model(context)
            if price is None
        )
    )
    source = (
        "Prices are those of the study's choices; the catalogue has none. "
        "Mounts, cables and computers are not included."
    )
    if not models:
        return f'<p class="note">{source}</p>'
    names = joined([f"<b>{escaped(model)}</b>" for model in models])
    missing = f"No price is known for {plural(len(models), 'model')}: {names}."
    return f'<p class="note">{missing} {source}</p>'


def _bold(text: str) -> Markup:
    return Markup(f"<b>{escaped(text)}</b>")


def _study_name(context: ReportContext) -> Markup:
    swatch = '<span class="swatch"></span>'
    return Markup(f'<span class="whose-{context.key}">{swatch} {escaped(context.name)}</span>')
