"""The tables [metric], [ap] and [fusion] of a study: read and written."""

from __future__ import annotations

from typing import Any

from ..base.setting_file import read_settings, settings_table
from ..base.table_reader import Table
from ..metric.entropy import ApCurve
from ..scoring.targets import TargetRule
from ..sensors import BLIND_RULES, KINDS, PerceptionModel

CLASSES = "objects"
"""The table of a kind's curves by class, in [ap.KIND]."""


def read_targets(table: Table) -> TargetRule:
    """Return whether voxels or objects are scored, from [metric]."""
    values = read_settings(table, TargetRule)
    table.finish()
    with table.naming():
        return TargetRule(**values)


def targets_table(targets: TargetRule) -> dict[str, Any] | None:
    """Return the table [metric]; None for the voxels of the paper."""
    if targets == TargetRule():
        return None
    return settings_table(targets)


def read_model(curves: Table, fusion: Table) -> PerceptionModel:
    """Return the perception model: AP curves of voxels and objects, the rule for blind sensors."""
    default = PerceptionModel()
    tables = {kind: curves.table(kind) for kind in KINDS}
    objects = {}
    for kind, table in tables.items():
        own = table.table(CLASSES)
        objects[kind] = {name: read_curve(own.table(name)) for name in own.names}
    by_kind = {kind: read_curve(table, default.curve(kind)) for kind, table in tables.items()}
    blind = fusion.text("blind", default.blind, BLIND_RULES)
    chosen = read_settings(curves, PerceptionModel)["model"]
    model = PerceptionModel(blind, objects=objects, model=chosen, **by_kind)
    curves.finish()
    fusion.finish()
    return model


def curves_table(model: PerceptionModel) -> dict[str, Any]:
    """Return the table [ap]: all curves by kind, and the model and classes that are not default."""
    named = settings_table(model) if model.model != PerceptionModel().model else {}
    return named | {
        kind: {
            **settings_table(curve),
            CLASSES: {n: settings_table(c) for n, c in model.objects.get(kind, {}).items()} or None,
        }
        for kind, curve in model.curves.items()
    }


def read_curve(table: Table, default: ApCurve | None = None) -> ApCurve:
    """Return an AP curve from its table; keys that are absent are those of the default."""
    curve = ApCurve(**read_settings(table, ApCurve, default=default))
    table.finish()
    return curve
