"""The warning record, numbers in texts, and the warning about a sensitivity to mounting errors."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any


def percent(share: float, digits: int | None = None) -> str:
    """Return a share, 0 to 1, in percent with `digits` decimals: "81.4%".

    Without `digits`: "85%" as in a sentence, with one decimal for shares near 0 or 1: "0.4%".
    """
    if digits is not None:
        return f"{100.0 * share:.{digits}f}%"
    value = 100.0 * share
    if 0.0 < value < 0.05:
        return "under 0.1%"
    if 99.95 <= value < 100.0:
        return "over 99.9%"
    return f"{value:.1f}%" if 0.0 < value < 9.95 or 99.5 <= value < 100.0 else f"{value:.0f}%"


def metres(length: float) -> str:
    """Return a length [m] as "5 cm", "1.45 m" or "84 m"."""
    if abs(length) < 0.995:
        return f"{100.0 * length:.0f} cm"
    return f"{length:.2f} m" if abs(length) < 9.995 else f"{length:.0f} m"


def times(factor: float) -> str:
    """Return a factor as "12 times" or "0.31 times"."""
    return f"{factor:.0f} times" if factor >= 9.5 else f"{factor:.2g} times"


def joined(texts: Sequence[str]) -> str:
    """Join texts: "a", "a and b", "a, b and c"."""
    if len(texts) < 2:
        return "".join(texts)
    return f"{', '.join(texts[:-1])} and {texts[-1]}"


FRAGILE = "fragile"
"""Code of the warning that concerns the placement of all sensors."""
UNMET = "requirement"
"""Code of the warning about a requirement that a search could not keep."""
PROVISIONAL = "provisional"
"""Code of the warning about AP curves that rest on a part of their runs."""
SUBJECTS = {FRAGILE: "placement", UNMET: "placement", PROVISIONAL: "AP curves"}
"""What warnings without a sensor concern, by code; others concern the vehicle."""


@dataclass(frozen=True, slots=True)
class Advice:
    """A warning about a probable mistake. Nothing is refused because of it.

    Attributes
    ----------
    subject : str or None
        Name of the sensor; None if the warning concerns the vehicle, the whole placement
        or the AP curves.
    code : str
        Identifier of the warning for programs: ``"inside"``, ``"size"``, ...
    text : str
        One sentence, without the name of the subject.
    part : str or None
        The part of the vehicle that causes the warning.
    fix : str or None
        Correction: "turn_vehicle" by `amount` degrees counter-clockwise, "scale_vehicle" by
        a factor, "move_vehicle" by x, y and z [m], "stand_vehicle" by degrees about x, y and z and
        then onto the ground and the origin, "roll_sensor" by degrees.
    amount : tuple of float
        Arguments of the fix.
    """

    subject: str | None
    code: str
    text: str
    part: str | None = None
    fix: str | None = None
    amount: tuple[float, ...] = ()

    @property
    def line(self) -> str:
        """The sentence after the name of its subject."""
        return f"{self.subject or SUBJECTS.get(self.code, 'vehicle')}: {self.text}"

    def to_dict(self) -> dict[str, Any]:
        """Return the warning as plain JSON data."""
        return {**asdict(self), "amount": list(self.amount)}


FRAGILE_NATS = 0.05
"""A rise of the mean entropy up to this [nats] is within the uncertainty of voxels and mounting."""
SURE = 2.0
"""A rise of at most this many standard errors is not significant."""


def fragile(
    rise: float, stderr: float, position: float, angle: float, tolerant: bool
) -> tuple[Advice, ...]:
    """Return a warning if the entropy of a placement rises much under mounting errors, or none.

    Parameters
    ----------
    rise, stderr : float
        Rise of the mean entropy over random mounting errors, and its standard error [nats].
    position, angle : float
        Standard deviations (1 sigma) of the errors [m, rad].
    tolerant : bool
        Whether the search already took such errors into account.
    """
    if rise <= max(FRAGILE_NATS, SURE * stderr):
        return ()
    advice = "" if tolerant else "; a search with a tolerance looks for one that is less fragile"
    text = f"{off_by(position, angle)} (1 sigma) it is {rise:.2f} nats worse on average{advice}"
    return (Advice(None, FRAGILE, text),)


def unmet(conflicts: Mapping[str, tuple[str, ...] | None]) -> tuple[Advice, ...]:
    """Return a warning for each requirement that a search could not keep.

    `conflicts` has the requirements that stand against each; None: it was met nowhere.
    """
    found = []
    for name, against in conflicts.items():
        text = f"{name} is not met; no placement was found that keeps all requirements"
        if against is None:
            text += ", and a short search found none that meets this one alone"
        elif against:
            text += f": a short search met it only by breaking {', '.join(against)}"
        else:
            text += ", though none stands against it: a longer search may"
        found.append(Advice(None, UNMET, text))
    return tuple(found)


def off_by(position: float, angle: float) -> str:
    """Describe mounting errors [m, rad], 1 sigma: "mounted 1 cm and 0.3 deg off"."""
    turned = f"{math.degrees(angle):.2g} deg"
    moved = f"{1000.0 * position:.2g} mm" if position < 0.00995 else metres(position)
    named = [*[moved] * (position > 0.0), *[turned] * (angle > 0.0)]
    return f"mounted {' and '.join(named)} off"
