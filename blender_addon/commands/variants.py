"""The verbs of the variants in a file: list them, put them side by side."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence

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
