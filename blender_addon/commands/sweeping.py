"""The verb ``sweep``: the scene's study, or those of variants, with changes."""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

from ..engine import app, pe
from .opened import opened_scene, opened_study
from .variants import studies_of

STUDIES = "studies"
"""The folder, in that of a sweep, for the studies it was made of."""


def sweep_scene(args: argparse.Namespace) -> app.Answer:
    """Write the studies to the sweep's folder, and sweep them as the command ``pe`` would."""
    studies = _studies(args.variants)
    folder = pe.prepare_folder(Path(args.output) / STUDIES)
    files = {}
    for number, (name, study) in enumerate(studies.items()):
        files[name] = folder / f"{number}.toml"
        pe.export_study(study, files[name])
    return app.sweep(files, args)


def _studies(variants: list[str]) -> dict[str, pe.Study]:
    """Return the studies by name: of variants, or of what stands in the scene."""
    if not variants:
        return {Path(bpy.data.filepath).stem or "scene": opened_study()}
    return studies_of(opened_scene(), variants)
