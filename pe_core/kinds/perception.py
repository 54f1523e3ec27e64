"""What a measurement is worth: the AP curves by kind, and the rule for blind sensors."""

from __future__ import annotations

from ..errors import InputError, shown
from ..metric.entropy import ApCurve
from ..text.values import choice
from .table import KINDS, kind_named

BLIND_RULES = ("floor", "literal")


class PerceptionModel:
    """The AP curve of every kind of sensor, and how late fusion takes sensors that see nothing.

    Parameters
    ----------
    blind : {"floor", "literal"}
        "floor": a sensor that sees nothing changes nothing. "literal": the literal formula (eq. 7),
        in which it votes.
    **curves : ApCurve
        By kind, ``lidar=ApCurve(0.2, 0.5)``; a kind's own by default. They are attributes as well:
        ``model.lidar`` is ``model.curve("lidar")``.

    Raises
    ------
    InputError
        When there is no such kind or rule, or a curve is none.
    """

    __slots__ = ("_curves", "blind")
    blind: str
    _curves: dict[str, ApCurve]

    def __init__(self, blind: str = "floor", **curves: ApCurve) -> None:
        choice("fusion", "blind", blind, BLIND_RULES)
        for name, curve in curves.items():
            kind_named(name, "perception model")
            if not isinstance(curve, ApCurve):
                raise InputError("perception model", name, "an ApCurve", shown(curve))
        object.__setattr__(self, "blind", blind)
        object.__setattr__(self, "_curves", dict(curves))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a perception model is fixed; {name} cannot be set")

    def __getattr__(self, kind: str) -> ApCurve:
        if kind in KINDS:
            return self.curve(kind)
        raise AttributeError(kind)

    def curve(self, kind: str) -> ApCurve:
        """Return the AP curve of a kind of sensor."""
        return self._curves.get(kind) or kind_named(kind, "perception model").curve

    @property
    def curves(self) -> dict[str, ApCurve]:
        """The curve of every kind there is."""
        return {kind: self.curve(kind) for kind in KINDS}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PerceptionModel):
            return NotImplemented
        return (self.blind, self.curves) == (other.blind, other.curves)

    def __hash__(self) -> int:
        return hash((self.blind, *self.curves.items()))

    def __repr__(self) -> str:
        curves = ", ".join(f"{kind}={curve!r}" for kind, curve in self.curves.items())
        return f"PerceptionModel(blind={self.blind!r}, {curves})"

    def __reduce__(self) -> tuple[object, ...]:
        return _model_again, (self.blind, self._curves)


def _model_again(blind: str, curves: dict[str, ApCurve]) -> PerceptionModel:
    """Build a model that was pickled: for worker processes."""
    return PerceptionModel(blind, **curves)
