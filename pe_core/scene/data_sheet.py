"""What a data sheet says of one sensor beside what it measures: mass, power, data rate; its price.

Nothing here changes a score. What is not known is None, which is not zero.
"""

from dataclasses import asdict, dataclass, replace
from typing import Any

from ..base.setting import Panel, check_settings, setting
from ..base.values import Number

PRICE = Number(0.0, cap=1e12, noun="price")


def _figure(unit: str, text: str, label: str, usual: float) -> Any:
    """Return the field of a figure, whose usual values are up to `usual`."""
    name = label.lower().replace(" ", "_")
    panel = Panel(name, f"{label} ({unit})", soft_max=usual, zero="the catalogue's", precision=2)
    text = f"{text}, in place of the catalogue's"
    return setting(None, Number(0.0, cap=1e6, unit=unit), text, panel)


@dataclass(frozen=True, slots=True)
class DataSheet:
    """Figures of one sensor that add up over a rig. `InputError` when one is below 0."""

    mass: float | None = _figure("kg", "Mass of one sensor", "Mass", 5.0)
    power: float | None = _figure("W", "Electric power that one sensor takes", "Power", 50.0)
    data_rate: float | None = _figure("Mbit/s", "Data that one sensor sends", "Data Rate", 1e3)
    price: float | None = setting(
        None,
        PRICE,
        "Price of one sensor. The catalogue has no prices",
        Panel("price", "Price", soft_max=1e5, zero="none", precision=2, step=1000),
    )

    def __post_init__(self) -> None:
        check_settings(self, "sensor")

    def over(self, other: "DataSheet") -> "DataSheet":
        """Return these figures, and those of another sheet where these are not known."""
        own = {key: value for key, value in asdict(self).items() if value is not None}
        return replace(other, **own)
