"""The studies of the paper's rows, and their variations."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import pe_core as pe

from .paper import Place

STUDIES = Path(__file__).resolve().parent.parent / "blend_assets" / "experiments"
"""The study files of a checkout."""


@cache
def study_of(name: str, folder: Path = STUDIES) -> pe.Study:
    """Return a row's study: its sensors at the paper's printed placement."""
    return pe.load_study(folder / f"{name}.toml")


def with_prior(study: pe.Study, name: str) -> pe.Study:
    """Return the study under another of the shipped priors, its focus kept."""
    makers = {"road": pe.Prior.road, "uniform": pe.Prior.uniform, "highway": pe.Prior.highway}
    return replace(study, prior=makers[name](study.prior.focus))


def placed(study: pe.Study, places: Mapping[str, Place]) -> pe.Study:
    """Return the study with its sensors at other positions, their yaw kept, level."""
    poses = [pe.Pose(places[s.name], (0.0, 0.0, s.pose.rpy[2])) for s in study.rig]
    return study.with_rig(study.rig.with_poses(poses))


def without_cameras(study: pe.Study) -> pe.Study:
    """Return the study with its LiDARs alone."""
    return study.with_rig(pe.Rig([s for s in study.rig if s.kind == "lidar"]))


def pitched(study: pe.Study, height: float, difference_deg: float) -> pe.Study:
    """Return a study of two LiDARs at one height, the second pitched by the difference."""
    pitches = (0.0, math.radians(difference_deg))
    poses = [
        pe.Pose((*s.pose.position[:2], height), (0.0, pitch, 0.0))
        for s, pitch in zip(study.rig, pitches, strict=True)
    ]
    return study.with_rig(study.rig.with_poses(poses))
