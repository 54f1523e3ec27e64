"""The verbs of the variants in a file: list them, put them side by side."""

from __future__ import annotations

import argparse
import json

import bpy

from .. import bridge, stale
from ..engine import app, pe
from .opened import from_file, opened_scene


def list_variants(args: argparse.Namespace) -> app.Answer:
    """List the variants with the scores that are kept with them."""
    scene = opened_scene()
    bridge.check_variants(scene, stale.fingerprint(scene))
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
    depsgraph = bpy.context.evaluated_depsgraph_get()
    studies = {}
    with from_file():
        for name in names:
            row = bridge.variant_named(scene, name)
            study = bridge.study_of_variant(scene, row, depsgraph)
            studies[name] = app.with_options(study, args)
    if not studies:
        raise pe.InputError(bpy.data.filepath, "variants", "at least one", "none")
    return app.compare(studies, args)
