"""The bill of materials: which sensors, how many, and what they cost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..engine import kinds, pe
from ..figures import count, joined
from ..markup import Markup, escaped, table
from ..prices import currency_of, money, price_of
from ..reviewed import Reviewed
from ..section import Section

NOT_KNOWN = "no price"


def bill(each: tuple[Reviewed, ...]) -> Section:
    """Return the bill of materials of a study, or of several in one table."""
    inside = _of_one(each[0]) if len(each) == 1 else _of_several(each)
    return Section("bill", "Bill of materials", f"{inside}{_missing(each)}")


BillRow = tuple[str, float | None]
"""A model's name and its unit price; None where the study gives none."""


def _positions(one: Reviewed) -> dict[BillRow, list[pe.Sensor]]:
    """Return the sensors of each model, in the rig's order."""
    found: dict[BillRow, list[pe.Sensor]] = {}
    for sensor in one.rig:
        key = sensor.model.name, price_of(one.found, sensor)
        found.setdefault(key, []).append(sensor)
    return found


def _of_one(one: Reviewed) -> str:
    heads = ("Sensor model", "Kind", "Sensors", "Count", "Unit price", "Sum")
    return table("Sensors", heads, _rows(one), css="bill")


def _rows(one: Reviewed) -> Iterator[list[str | Markup]]:
    unit = currency_of(one.found)
    for (model, price), sensors in _positions(one).items():
        names = ", ".join(sensor.name for sensor in sensors)
        yield [
            *(model, kinds.kind_of(sensors[0]).label, names, str(len(sensors))),
            NOT_KNOWN if price is None else money(price, unit),
            NOT_KNOWN if price is None else money(price * len(sensors), unit),
        ]
    total = str(len(tuple(one.rig)))
    yield [_bold("All sensors"), "", "", _bold(total), "", _bold(_total(one))]


def _of_several(each: Sequence[Reviewed]) -> str:
    positions = dict.fromkeys(key for one in each for key in _positions(one))
    heads: list[str | Markup] = ["Sensor model", "Unit price"]
    heads += [_named(one) for one in each]
    rows: list[list[str | Markup]] = []
    unit = currency_of(each[0].found)
    for key in positions:
        model, price = key
        numbers = [str(len(_positions(one).get(key, ())) or "–") for one in each]
        rows.append([model, NOT_KNOWN if price is None else money(price, unit), *numbers])
    rows.append([_bold("Count"), "", *(_bold(str(len(tuple(one.rig)))) for one in each)])
    rows.append([_bold("Sum"), "", *(_bold(_total(one)) for one in each)])
    return table("Sensors of each study", heads, rows)


def _total(one: Reviewed) -> str:
    """Return what all sensors cost; of those whose price is known, "at least" so much."""
    prices = [price_of(one.found, sensor) for sensor in one.rig]
    known = [price for price in prices if price is not None]
    if not known:
        return NOT_KNOWN
    total = money(sum(known), currency_of(one.found))
    return total if len(known) == len(prices) else f"at least {total}"


def _missing(each: Sequence[Reviewed]) -> str:
    """Say of which models no price is known, and where prices are from."""
    models = list(
        dict.fromkeys(model for one in each for model, price in _positions(one) if price is None)
    )
    source = "Prices are those of the study's choices; the catalogue has none."
    if not models:
        return f'<p class="note">{source} Mounts, cables and computers are not in it.</p>'
    named = joined([f"<b>{escaped(model)}</b>" for model in models])
    lacking = f"No price is known of {count(len(models), 'model')}: {named}."
    return f'<p class="note">{lacking} {source} Mounts, cables and computers are not in it.</p>'


def _bold(text: str) -> Markup:
    return Markup(f"<b>{escaped(text)}</b>")


def _named(one: Reviewed) -> Markup:
    return Markup(
        f'<span class="whose-{one.key}"><span class="swatch"></span> {escaped(one.name)}</span>'
    )
