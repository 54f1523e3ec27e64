"""The warning record, and warnings about a placement as a whole."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from pe_core.base.codec import Recorded
from pe_core.scoring.score import SURE
from pe_core.search import Reading

from ..wording import warning_text

if TYPE_CHECKING:
    from pe_core.study import Suggestion

FRAGILE = "fragile"  # Code of the warning that concerns the placement of all sensors
UNMET = "requirement"  # Code of the warning about a requirement that a search could not keep
NOT_KEPT = "figure"  # Code of the warning about a key figure that a search could not keep
SUBJECTS = {FRAGILE: "placement", UNMET: "placement", NOT_KEPT: "search", "returns": "returns"}
SUBJECTS |= {"range_term": "AP curves"}
"""What warnings without a sensor concern, by code; others concern the vehicle."""
FRAGILE_NATS = 0.05
"""A rise of the mean entropy up to this [nats] is within the uncertainty of voxels and mounting."""


@dataclass(frozen=True, slots=True)
class Advice(Recorded):
    """A warning about a probable mistake. Nothing is refused because of it.

    Attributes
    ----------
    subject : str or None
        Name of the sensor; None if the warning concerns the vehicle, the whole placement
        or the AP curves.
    code : str
        Identifier of the warning for programs: ``"inside"``, ``"size"``, ...
    values : mapping
        What the warning says, in plain values: `pe_tools.wording.WARNINGS` by code.
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
    values: Mapping[str, Any] = field(default_factory=dict, hash=False)
    part: str | None = None
    fix: str | None = None
    amount: tuple[float, ...] = ()

    @property
    def text(self) -> str:
        """The warning in a sentence, without the name of its subject."""
        return warning_text(self.code, self.part, self.values)

    @property
    def line(self) -> str:
        """The sentence after the name of its subject."""
        return f"{self.subject or SUBJECTS.get(self.code, 'vehicle')}: {self.text}"


def fragile(
    rise: float, stderr: float, position: float, angle: float, tolerant: bool
) -> tuple[Advice, ...]:
    """Return a warning if the entropy of a placement rises much under mounting errors, or none.
    `rise` is that of the mean entropy, with its standard error [nats], under errors of `position`
    [m] and `angle` [rad], 1 sigma; a `tolerant` search already took them into account."""
    if rise <= max(FRAGILE_NATS, SURE * stderr):
        return ()
    values = {"rise": rise, "position": position, "angle": angle, "tolerant": tolerant}
    return (Advice(None, FRAGILE, values),)


def unmet(found: "Mapping[str, Suggestion | None]") -> tuple[Advice, ...]:
    """Return a warning for each requirement that a search could not keep. `found` has the nearest
    placement that meets each, and what it breaks; None: it was met nowhere."""
    return tuple(
        Advice(None, UNMET, {"name": name, "against": own and list(own.breaks)})
        for name, own in found.items()
    )


def not_kept(rows: Iterable[Reading]) -> tuple[Advice, ...]:
    """Return a warning for each key figure that a search was to keep as wanted, and could not."""
    return tuple(
        Advice(None, NOT_KEPT, {"name": row.figure.name, "told": row.text})
        for row in rows
        if row.kept and row.met is False and row.figure.is_seen
    )
