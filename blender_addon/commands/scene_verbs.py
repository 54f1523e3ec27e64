"""Verbs that the open scene does otherwise than a study file, and its list of variants."""

import argparse
from pathlib import Path

import bpy

from .. import document
from ..caches import result_staleness
from ..engine import app, pe, text
from ..view import film
from .open_file import from_file, opened_scene, quiet_blender
from .scene_source import SceneStudies


def check_scene(source: SceneStudies, args: argparse.Namespace) -> app.Answer:
    """Hold the scene to its requirements and scenarios; one scenario is rendered as a film, where
    the output is one."""
    path = Path(args.output or "")
    if path.suffix not in film.FORMATS:
        return app.check(source, args)
    study = source.study(args)
    scenario, *others = app.chosen_scenarios(study, app.scenario_names(args.scenarios))
    text.require_new(path, replace=args.replace)
    if others:
        raise pe.InputError("check", "scenarios", "one for a film", 1 + len(others))
    args.output = None
    args.scenarios = args.scenarios or ""
    answer = app.check_study(study, args, source)
    with quiet_blender():
        film.write_film(bpy.context.scene, study, scenario, path)
    app.tell(f"wrote {path}")
    return answer


def where_in_scene(source: SceneStudies, args: argparse.Namespace) -> app.Answer:
    """Score one more sensor all over the surface of the scene's vehicle."""
    study = source.study(args)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    with from_file():
        study = document.with_mount(study, bpy.context.scene, depsgraph, args.mount)
    return app.where_study(study, args)


def list_variants(_: SceneStudies, args: argparse.Namespace) -> app.Answer:
    """List the variants with the scores that are kept with them."""
    scene = opened_scene()
    document.check_variants(scene, result_staleness.fingerprint(scene))
    data = [document.variant_dict(scene, row) for row in scene.perception_entropy.variants]
    return app.answered(args, data, map(_listed, data) if data else ["no variants"]), app.DONE


def _listed(row: dict) -> str:
    """One line of the list: which one stands in the scene, its name, its score."""
    score = "not scored" if row["entropy"] is None else f"{row['entropy']:.3f} nats"
    old = "  (scored before vehicle, prior or settings changed)" if row["stale"] else ""
    return f"{'*' if row['active'] else ' '} {row['name']}  {score}{old}"
