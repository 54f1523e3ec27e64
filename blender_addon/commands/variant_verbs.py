"""Verbs that take variants: ``variants``, ``compare``, ``sweep`` and ``review``."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import bpy

from .. import bridge, result_staleness
from ..engine import app, page, pe
from .open_file import from_file, opened_scene, opened_study
from .streams import quiet_blender


def list_variants(args: argparse.Namespace) -> app.Answer:
    """List the variants with the scores that are kept with them."""
    scene = opened_scene()
    bridge.check_variants(scene, result_staleness.fingerprint(scene))
    data = [bridge.variant_dict(scene, row) for row in scene.perception_entropy.variants]
    if args.json:
        return json.dumps(data, indent=2), app.DONE
    return "\n".join(map(_listed, data)) or "no variants", app.DONE


def _listed(row: dict) -> str:
    """One line of the list: which one stands in the scene, its name, its score."""
    score = "not scored" if row["entropy"] is None else f"{row['entropy']:.4f} nats"
    old = "  (scored before vehicle, prior or settings changed)" if row["stale"] else ""
    return f"{'*' if row['active'] else ' '} {row['name']}  {score}{old}"


def compare_variants(args: argparse.Namespace) -> app.Answer:
    """Score variants where they are kept, and put them side by side."""
    scene = opened_scene()
    names = args.variants or [row.name for row in scene.perception_entropy.variants]
    studies = {n: app.with_options(s, args) for n, s in studies_of(scene, names).items()}
    if not studies:
        raise pe.InputError(bpy.data.filepath, "variants", "at least one", "none")
    return app.compare(studies, args)


def studies_of(scene: bpy.types.Scene, names: Sequence[str]) -> dict[str, pe.Study]:
    """Return the studies of variants where they are kept, by name."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    with from_file():
        rows = {name: bridge.variant_named(scene, name) for name in names}
        return {n: bridge.study_of_variant(scene, row, depsgraph) for n, row in rows.items()}


STUDIES = "studies"
"""The folder, in that of a sweep, for the studies it was made of."""


def sweep_scene(args: argparse.Namespace) -> app.Answer:
    """Write the studies to the sweep's folder, and sweep them as the command ``pe`` would."""
    studies = _studies_to_sweep(args.variants)
    folder = pe.prepare_folder(Path(args.output) / STUDIES)
    files = {}
    for number, (name, study) in enumerate(studies.items()):
        files[name] = folder / f"{number}.toml"
        pe.export_study(study, files[name])
    return app.sweep(files, args)


def _studies_to_sweep(variants: list[str]) -> dict[str, pe.Study]:
    """Return the studies by name: of variants, or of what stands in the scene."""
    if not variants:
        return {Path(bpy.data.filepath).stem or "scene": opened_study()}
    return studies_of(opened_scene(), variants)


def review_scene(args: argparse.Namespace) -> app.Answer:
    """Score what stands in the scene, or variants, and write the page."""
    if args.variants:
        studies = studies_of(opened_scene(), args.variants)
    else:
        studies = {Path(bpy.data.filepath).stem or "scene": opened_study()}
    # The picture shows the scene's own vehicle: variants have theirs drawn.
    picture = rendered if args.render and not args.variants else None
    return page.review_studies(studies, args, picture, bridge.blender_version())


def rendered(outcome: pe.Outcome) -> bytes:
    """Return Blender's picture of an outcome, PNG."""
    from .. import review  # only who wants a picture pays for it

    with quiet_blender():
        return review.picture_of(bpy.context.scene, outcome)
