"""A piece of advice: what is odd about a sensor or the vehicle, in plain words."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

FRAGILE = "fragile"
"""Code of the warning that is of all sensors' placement."""


@dataclass(frozen=True, slots=True)
class Advice:
    """Something that is probably not meant as it is. It is told; nothing is refused.

    Attributes
    ----------
    subject : str or None
        Name of the sensor that it concerns; None for the vehicle, or all sensors' placement.
    code : str
        Which warning it is, for programs: ``"inside"``, ``"size"``, ...
    text : str
        One plain sentence, without the subject's name.
    part : str or None
        The part of the vehicle that causes it.
    fix : str or None
        What would mend it: "turn_vehicle" by `amount` degrees counter-clockwise, "scale_vehicle" by
        a factor, "move_vehicle" by x, y and z [m], "roll_sensor" by degrees.
    amount : tuple of float
        How much of the fix.
    """

    subject: str | None
    code: str
    text: str
    part: str | None = None
    fix: str | None = None
    amount: tuple[float, ...] = ()

    @property
    def line(self) -> str:
        """The sentence with whom it concerns."""
        whole = "placement" if self.code == FRAGILE else "vehicle"
        return f"{self.subject or whole}: {self.text}"

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON data."""
        return {**asdict(self), "amount": list(self.amount)}
