"""Voxels or objects: what a scene is judged on, and what was found of objects."""

from __future__ import annotations

import bpy

from ..choices import OBJECTS
from ..engine import advice, pe


def targets_of(settings: bpy.types.PropertyGroup) -> pe.TargetRule:
    """Return what a scene's settings say; traffic and scenes are of objects alone."""
    if settings.targets != OBJECTS:
        return pe.TargetRule()
    return pe.TargetRule(OBJECTS, settings.traffic, settings.scenes)


def put_targets(settings: bpy.types.PropertyGroup, rule: pe.TargetRule) -> None:
    """Write them to a scene's settings."""
    settings.targets, settings.traffic = rule.targets, rule.traffic
    settings.scenes = rule.scenes


def targets_signature(settings: bpy.types.PropertyGroup) -> list[object]:
    """Return what of it a score depends on, where it is not as usual."""
    rule = targets_of(settings)
    return [] if rule == pe.TargetRule() else [rule.targets, rule.traffic, rule.scenes]


def store_found(settings: bpy.types.PropertyGroup, found: pe.ObjectScore | None) -> None:
    """Keep what a score found of objects, for the panel: in all, and by class."""
    settings.result_ap = ""
    if found is None:
        return
    settings.result_ap = f"{found.ap:.3f} \N{PLUS-MINUS SIGN} {max(found.ap_stderr, 1e-3):.3f}"
    by_name = {_shown(name): own for name, own in found.per_class.items()}
    for row in settings.result_parts:
        own = by_name.get(row.name) if row.is_class else None
        if own is not None:
            row.ap = f"{own.ap:.2f}"
            row.reach = advice.lone_reach(own.reach["front"])


def _shown(name: str) -> str:
    return name[:1].upper() + name[1:]
