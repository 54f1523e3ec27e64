"""Migration of files of older versions, step by step, as plain values; scores as plain data."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace

import bpy

from ..choices import VERSION
from ..engine import advice, pe

EARLIER = "This was scored by an earlier version: score again"


@dataclass(frozen=True, slots=True)
class Stored:
    """Stored settings in which versions differ; fields have the names of the properties."""

    version: int = 0
    has_result: bool = False
    result_json: str = ""
    result_words: str = ""
    result_stale: bool = False


def migrated(old: Stored) -> Stored:
    """Return settings in the form of this version; settings of a newer version are unchanged."""
    while old.version in STEPS:
        old = replace(STEPS[old.version](old), version=old.version + 1)
    return old


def _with_text(old: Stored) -> Stored:
    """Migrate to version 1, which stores the sentences of a result and a new signature."""
    if not old.has_result:
        return old
    return replace(old, result_words="\n".join(_text_of(old.result_json)), result_stale=True)


STEPS: dict[int, Callable[[Stored], Stored]] = {0: _with_text}
"""The step from each version to the next."""


def migrate_scene(scene: bpy.types.Scene) -> None:
    """Migrate a scene's settings; a scene linked from another file is not changed."""
    if scene.library is not None:
        return
    settings = scene.perception_entropy
    old = Stored(**{name: getattr(settings, name) for name in Stored.__slots__})
    new = migrated(old)
    for name in Stored.__slots__:
        if getattr(new, name) != getattr(old, name):
            setattr(settings, name, getattr(new, name))


def newer_version_message(scene: bpy.types.Scene) -> str:
    """Return a warning about a scene that a newer version wrote; "" for others."""
    version = scene.perception_entropy.version
    if version <= VERSION:
        return ""
    return (
        f"scene {scene.name!r} is of a newer version of the extension ({version}; this one knows "
        f"{VERSION}): what is new in it is not shown here"
    )


def score_to_dict(score: pe.Score) -> dict:
    """Return a score as plain data, with the scatter that the error of a difference needs."""
    scatter = {} if score.scatter is None else {"scatter": score.scatter.to_dict()}
    return {**score.to_dict(), **scatter}


def score_from_dict(figures: dict) -> pe.Score:
    """Return a score from plain data, without the scores of its sensors."""
    by_class, by_zone = (
        {name: pe.PartScore(**part) for name, part in figures[which].items()}
        for which in ("per_class", "per_zone")
    )
    whole = (figures["entropy"], figures["coverage"], figures["stderr"])
    objects = figures.get("objects")
    object_score = None if objects is None else pe.ObjectScore.from_dict(objects)
    scatter = figures.get("scatter")
    residuals = None if scatter is None else pe.Scatter.from_dict(scatter)
    voxels = figures["voxels"]
    return pe.Score(*whole, by_class, by_zone, {}, voxels, objects=object_score, scatter=residuals)


def _text_of(result_json: str) -> tuple[str, ...]:
    try:
        return advice.rig_words(score_from_dict(json.loads(result_json)["after"]))
    except (ValueError, KeyError, TypeError):  # a damaged result has no sentences
        return (EARLIER,)
