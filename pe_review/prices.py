"""What sensors cost, where a study says so: in its choices. The catalogue knows no prices."""

from __future__ import annotations

from .engine import pe


def price_of(study: pe.Study, sensor: pe.Sensor) -> float | None:
    """Return what a sensor costs, in the study's own unit; None where the study does not say.

    The choice that names the sensor comes first, else any choice that offers its model.
    """
    own = [choice for choice in study.selection.choices if sensor.name in (choice.sensors or ())]
    for choice in (*own, *study.selection.choices):
        for option in choice.options:
            if option.model.name == sensor.model.name:
                return option.price
    return None


def money(price: float, currency: str) -> str:
    """Return a price with its unit: "12,500 EUR", "99.50"."""
    figure = f"{price:,.0f}" if float(price).is_integer() else f"{price:,.2f}"
    return f"{figure} {currency}".strip()


def currency_of(study: pe.Study) -> str:
    """Return the unit of a study's prices; empty where it gives none."""
    return study.selection.currency or ""
