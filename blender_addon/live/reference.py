"""What a live score is compared with: the sensors before the last move, pinned ones, a variant.

Plain data and rules, without Blender: `session` says what moves, `background` works out what is not
known yet.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

from ..engine import pe

MOVE_LABEL, PINNED_LABEL = "before this move", "pinned sensors"


def rig_key(rig: pe.Rig) -> Hashable:
    """Return plain values that tell a rig from others; the catalogue has one object a model."""
    return tuple((s.name, id(s.model), s.pose, s.group, s.curve) for s in rig)


@dataclass(slots=True, eq=False)
class Baseline:
    """What a live score is compared with.

    Attributes
    ----------
    label : str
        What it is, in words: "before this move".
    rig : Rig or None
        Its sensors. None where only its score is known: the vehicle was another one.
    glance : Glance or None
        Its score, on the sample of the live score; None until it has been worked out.
    """

    label: str
    rig: pe.Rig | None
    glance: pe.Glance | None = None


@dataclass(frozen=True, slots=True)
class ReadRig:
    """The rig that was read of a scene last, and its exact score where that is known."""

    rig: pe.Rig
    glance: pe.Glance | None


class Moves:
    """Tells where a move begins, and keeps what stood there before, scene by scene.

    A move lasts as long as the operator that moves with the mouse. Blender ends the operator before
    the update that puts the sensors where they were let go, or back where they were: the first
    update without an operator still belongs to the move. An update that moves no sensor begins
    none.
    """

    def __init__(self) -> None:
        self._operators: dict[str, int] = {}
        self._before: dict[str, Baseline] = {}

    def note(self, scene: str, operator: int, last: ReadRig | None, now: pe.Rig | None) -> None:
        """Note an update in which something moves.

        Parameters
        ----------
        scene : str
        operator : int
            Number of the operator that moves with the mouse; 0 when there is none.
        last : ReadRig or None
            What was read before this update.
        now : Rig or None
            What is read in it; None when it is the vehicle that moves.
        """
        under_way = self._operators.get(scene, 0)
        if under_way and operator in (0, under_way):
            self._operators[scene] = operator
            return
        if last is None or (now is not None and rig_key(now) == rig_key(last.rig)):
            return
        self._operators[scene] = operator
        if operator or last.glance is not None:  # else: a field is dragged, or typed in, in a row
            self._before[scene] = Baseline(
                MOVE_LABEL, None if now is None else last.rig, last.glance
            )

    def end(self) -> None:
        """All rests, and no operator moves anything: what moves next is another move."""
        self._operators.clear()

    def before(self, scene: str) -> Baseline | None:
        """Return what stood before the move that is under way, or the last one."""
        return self._before.get(scene)

    def drop(self, scene: str) -> None:
        """Forget what stood before: it cannot be compared with what stands there now."""
        self._before.pop(scene, None)

    def clear(self) -> None:
        """Forget everything."""
        self._operators.clear()
        self._before.clear()
