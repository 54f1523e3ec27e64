"""What a measurement is worth: the AP curves by kind, and the rule for blind sensors."""

from __future__ import annotations

from collections.abc import Mapping

from ..errors import InputError, shown
from ..metric.entropy import ApCurve
from ..text.fixed import FixedDict
from ..text.values import A_NAME, choice
from .object_curves import ClassCurves
from .table import KINDS, kind_named

BLIND_RULES = ("floor", "literal")


class PerceptionModel:
    """The AP curve of every kind of sensor, and how late fusion takes sensors that see nothing.

    Parameters
    ----------
    blind : {"floor", "literal"}
        "floor": a sensor that sees nothing changes nothing. "literal": the literal formula (eq. 7),
        in which it votes.
    objects : mapping of kind to mapping of class to ApCurve
        Curves of whole objects, m counted on the object, in place of the shipped ones.
    **curves : ApCurve
        By kind, ``lidar=ApCurve(0.2, 0.5)``; a kind's own by default. They are attributes as well:
        ``model.lidar`` is ``model.curve("lidar")``.

    Raises
    ------
    InputError
        When there is no such kind or rule, or a curve is none.
    """

    __slots__ = ("_curves", "blind", "objects")
    blind: str
    objects: ClassCurves
    _curves: dict[str, ApCurve]

    def __init__(
        self, blind: str = "floor", *, objects: ClassCurves | None = None, **curves: ApCurve
    ) -> None:
        choice("fusion", "blind", blind, BLIND_RULES)
        for name, curve in curves.items():
            kind_named(name, "perception model")
            if not isinstance(curve, ApCurve):
                raise InputError("perception model", name, "an ApCurve", shown(curve))
        object.__setattr__(self, "blind", blind)
        object.__setattr__(self, "_curves", dict(curves))
        object.__setattr__(self, "objects", _checked(objects or {}))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a perception model is fixed; {name} cannot be set")

    def __getattr__(self, kind: str) -> ApCurve:
        if kind in KINDS:
            return self.curve(kind)
        raise AttributeError(kind)

    def curve(self, kind: str) -> ApCurve:
        """Return the AP curve of a kind of sensor."""
        return self._curves.get(kind) or kind_named(kind, "perception model").curve

    def object_curve(self, kind: str, name: str) -> ApCurve:
        """Return the AP curve of whole objects of a class, by the beams or pixels on each.

        Raises
        ------
        InputError
            When there is none.
        """
        shipped = kind_named(kind, "perception model").object_curves
        found = self.objects.get(kind, {}).get(name) or shipped.get(name)
        if found is None:
            field = f"[ap.{kind}.objects.{name}]"
            expected = f"a and b of {name!r} as an object (pe fit finds them)"
            raise InputError("perception model", field, expected, "none")
        return found

    @property
    def curves(self) -> dict[str, ApCurve]:
        """The curve of every kind there is."""
        return {kind: self.curve(kind) for kind in KINDS}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PerceptionModel):
            return NotImplemented
        mine, others = ((m.blind, m.curves, m.objects) for m in (self, other))
        return mine == others

    def __hash__(self) -> int:
        objects = ((kind, frozenset(own.items())) for kind, own in self.objects.items())
        return hash((self.blind, *self.curves.items(), frozenset(objects)))

    def __repr__(self) -> str:
        curves = ", ".join(f"{kind}={curve!r}" for kind, curve in self.curves.items())
        objects = f", objects={dict(self.objects)!r}" if self.objects else ""
        return f"PerceptionModel(blind={self.blind!r}, {curves}{objects})"

    def __reduce__(self) -> tuple[object, ...]:
        return _model_again, (self.blind, self._curves, dict(self.objects))


def _model_again(
    blind: str, curves: dict[str, ApCurve], objects: dict[str, dict[str, ApCurve]]
) -> PerceptionModel:
    """Build a model that was pickled: for worker processes."""
    return PerceptionModel(blind, objects=objects, **curves)


def _checked(objects: ClassCurves) -> ClassCurves:
    """Return curves by kind and class, for good; kinds without any are left out."""
    if not isinstance(objects, Mapping):
        raise InputError("perception model", "objects", "curves by kind", shown(objects))
    for kind, own in objects.items():
        kind_named(kind, "perception model", "objects")
        for name, curve in own.items():
            A_NAME.checked("perception model", f"objects of {kind}", name)
            if not isinstance(curve, ApCurve):
                field = f"{kind}.objects.{name}"
                raise InputError("perception model", field, "an ApCurve", shown(curve))
    return FixedDict({kind: own for kind, own in objects.items() if own})
