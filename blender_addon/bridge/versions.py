"""The version of the stored settings; scores as plain data."""

from __future__ import annotations

from bpy.types import Scene

from ..choices import VERSION
from ..engine import advice, pe


def mark_version(scene: Scene) -> None:
    """Mark a scene as one of this version; those of a newer one and of another file stay."""
    settings = scene.perception_entropy
    if scene.library is None and settings.version < VERSION:
        settings.version = VERSION


def newer_version_message(scene: Scene) -> str:
    """Return a warning about a scene that a newer version wrote; "" for others."""
    version = scene.perception_entropy.version
    if version <= VERSION:
        return ""
    return (
        f"scene {scene.name!r} is of a newer version of the extension ({version}; this one knows "
        f"{VERSION}): what is new in it is not shown here"
    )


def scored_data(score: pe.Score, figures: advice.KeyFigures | None = None) -> dict:
    """Return a score as plain data, with the scatter that the error of a difference needs, and the
    key figures beside it."""
    scatter = {} if score.scatter is None else {"scatter": score.scatter.to_dict()}
    beside = {} if figures is None else {"figures": figures.to_dict()}
    return {**score.to_dict(), **scatter, **beside}


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
