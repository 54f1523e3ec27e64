"""Files of older versions brought up to date: what is stored, step by step, as plain values."""

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
    """What a scene's settings hold that versions differ in; names are the settings' own."""

    version: int = 0
    has_result: bool = False
    result_json: str = ""
    result_words: str = ""
    result_stale: bool = False


def migrated(old: Stored) -> Stored:
    """Return settings as this version would have stored them; newer ones stay as they are."""
    while old.version in STEPS:
        old = replace(STEPS[old.version](old), version=old.version + 1)
    return old


def _with_words(old: Stored) -> Stored:
    """Results are told in words since version 1, and are known to stand by another signature."""
    if not old.has_result:
        return old
    return replace(old, result_words="\n".join(_words_of(old.result_json)), result_stale=True)


STEPS: dict[int, Callable[[Stored], Stored]] = {0: _with_words}
"""What makes of a version the next one."""


def bring_up_to_date(scene: bpy.types.Scene) -> None:
    """Migrate a scene's settings; one of another file is left as that file has it."""
    if scene.library is not None:
        return
    settings = scene.perception_entropy
    old = Stored(**{name: getattr(settings, name) for name in Stored.__slots__})
    new = migrated(old)
    for name in Stored.__slots__:
        if getattr(new, name) != getattr(old, name):
            setattr(settings, name, getattr(new, name))


def newer_version(scene: bpy.types.Scene) -> str:
    """Return a line on a scene that a newer version wrote; "" for others."""
    version = scene.perception_entropy.version
    if version <= VERSION:
        return ""
    return (
        f"scene {scene.name!r} is of a newer version of the extension ({version}; this one knows "
        f"{VERSION}): what is new in it is not seen here"
    )


def figures_of(score: pe.Score) -> dict:
    """Return a score's plain data, with the scatter that errors of differences come from."""
    scatter = {} if score.scatter is None else {"scatter": score.scatter.to_dict()}
    return {**score.to_dict(), **scatter}


def score_from_dict(figures: dict) -> pe.Score:
    """Return a score from its plain data: all but its sensors' part."""
    by_class, by_zone = (
        {name: pe.PartScore(**part) for name, part in figures[which].items()}
        for which in ("per_class", "per_zone")
    )
    whole = (figures["entropy"], figures["coverage"], figures["stderr"])
    objects = figures.get("objects")
    found = None if objects is None else pe.ObjectScore.from_dict(objects)
    scatter = figures.get("scatter")
    kept = None if scatter is None else pe.Scatter.from_dict(scatter)
    voxels = figures["voxels"]
    return pe.Score(*whole, by_class, by_zone, {}, voxels, objects=found, scatter=kept)


def _words_of(result_json: str) -> tuple[str, ...]:
    try:
        return advice.rig_words(score_from_dict(json.loads(result_json)["after"]))
    except (ValueError, KeyError, TypeError):  # a damaged result says nothing
        return (EARLIER,)
