"""What a score is made of: a study's [metric], [ap] and [fusion], to objects and back."""

from __future__ import annotations

from typing import Any

from ..errors import InputError
from ..kinds import BLIND_RULES, KINDS, PerceptionModel
from ..metric.entropy import ApCurve
from ..targets import TARGETS, TargetRule
from ..text.tables import Table

CLASSES = "objects"
"""The table of a kind's curves by class, in [ap.KIND]."""


def read_targets(table: Table) -> TargetRule:
    """Return what is judged."""
    default = TargetRule()
    values = (
        table.text("targets", default.targets, TARGETS),
        table.raw("traffic", default.traffic),
        table.whole("scenes", default.scenes),
    )
    table.finish()
    try:
        return TargetRule(*values)
    except InputError as error:
        raise table.error(error.field, error.expected, error.found) from None


def targets_table(targets: TargetRule) -> dict[str, Any] | None:
    """Return the table of what is judged; none for the paper's voxels."""
    if targets == TargetRule():
        return None
    return {"targets": targets.targets, "traffic": targets.traffic, "scenes": targets.scenes}


def read_model(curves: Table, fusion: Table) -> PerceptionModel:
    """Return the perception model: curves of voxels and of objects, and the rule for the blind."""
    default = PerceptionModel()
    tables = {kind: curves.table(kind) for kind in KINDS}
    objects = {kind: _read_objects(table.table(CLASSES)) for kind, table in tables.items()}
    own = {kind: _read_curve(table, default.curve(kind)) for kind, table in tables.items()}
    blind = fusion.text("blind", default.blind, BLIND_RULES)
    model = PerceptionModel(blind, objects=objects, **own)
    curves.finish()
    fusion.finish()
    return model


def curves_table(model: PerceptionModel) -> dict[str, Any]:
    """Return the table of all curves by kind, and of those by class that are no shipped ones."""
    return {
        kind: {"a": c.a, "b": c.b, CLASSES: _objects_table(model, kind)}
        for kind, c in model.curves.items()
    }


def _read_objects(table: Table) -> dict[str, ApCurve]:
    found = {}
    for name in table.names:
        own = table.table(name)
        found[name] = ApCurve(own.number("a"), own.number("b"))
        own.finish()
    return found


def _objects_table(model: PerceptionModel, kind: str) -> dict[str, Any] | None:
    own = model.objects.get(kind, {})
    return {name: {"a": c.a, "b": c.b} for name, c in own.items()} or None


def _read_curve(table: Table, default: ApCurve) -> ApCurve:
    curve = ApCurve(table.number("a", default.a), table.number("b", default.b))
    table.finish()
    return curve
