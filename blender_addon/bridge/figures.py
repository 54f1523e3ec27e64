"""Blind ground, reach ahead and expected AP: what a scene tells them of, and a variant's own."""

from __future__ import annotations

import json
from typing import NamedTuple

import bpy

from ..engine import advice, pe
from .fingerprint import Fingerprint
from .variants import Variant


class FigureRule(NamedTuple):
    """For what height blind ground is told [m], and for which class reach and AP."""

    height: float
    class_name: str


def figure_rule(scene: bpy.types.Scene, prior: pe.Prior) -> FigureRule:
    """Return what figures are told of: as the 3D view's blind ground and reach are set."""
    view, classes = scene.perception_entropy.view, prior.class_names
    chosen = view.reach_class if view.reach_class in classes else classes[0]
    return FigureRule(int(view.blind_height.removeprefix("H")) / 100.0, chosen)


def figures_signature(scene: bpy.types.Scene, now: Fingerprint) -> str:
    """Return what tells figures from others, besides the sensors: plain settings of the scene."""
    view = scene.perception_entropy.view
    return f"{now.surroundings} {view.blind_height} {view.reach_class}"


def write_figures(variant: Variant, found: advice.KeyFigures, signature: str) -> None:
    """Keep figures with a variant."""
    variant.figures_json, variant.figures_of = json.dumps(found.to_dict()), signature


def figures_of(variant: Variant, signature: str) -> advice.KeyFigures | None:
    """Return a variant's figures; None where there are none of this signature."""
    if not variant.figures_json or variant.figures_of != signature:
        return None
    return advice.KeyFigures(**json.loads(variant.figures_json))
