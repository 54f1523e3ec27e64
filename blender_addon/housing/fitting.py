"""Keeps a sensor's housing that of its model: another model chosen, another body."""

from __future__ import annotations

import bpy

from .. import changes, roster
from ..engine import catalog
from .meshes import KEY, housing_mesh


def fit_all() -> None:
    """Give sensors that have another model's housing their own."""
    for scene in bpy.data.scenes:
        for obj in roster.sensors(scene):
            model = obj.perception_entropy.model
            worn = obj.data.get(KEY, model) if obj.type == "MESH" else model
            if worn != model and model in catalog.entries() and obj.is_editable:
                obj.data = housing_mesh(model)


def register() -> None:
    """Start listening to what may change a model."""
    changes.study.connect(fit_all)


def unregister() -> None:
    """Stop listening."""
    changes.study.disconnect(fit_all)
