"""Verbs of the scene and of its variants: what each does with the open file."""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import bpy

from .. import bridge, film, result_staleness
from ..engine import app, jobs, page, pe, studies, text
from .open_file import (
    OPTIMIZED,
    from_file,
    opened_scene,
    opened_study,
    quiet_blender,
    write_front,
    write_optimized,
)


def run_job(args: argparse.Namespace) -> app.Answer:
    """Score or optimize, and write the results to the output folder; the designs of a front are
    variants of the new scene."""
    study, searches = app.with_options(opened_study(args.variant), args), args.kind == "optimize"
    is_front = searches and jobs.has_front(study)
    if searches:
        with from_file():
            check = bridge.check_choosable if is_front else bridge.check_placeable
            check(bpy.context.scene, study)

    def leave(found: jobs.Outcome | jobs.TradeOff, data: dict, folder: Path) -> None:
        with quiet_blender():
            if isinstance(found, jobs.TradeOff):
                write_front(found, folder)
            else:
                write_optimized(found, data, folder)

    host, notes = bridge.blender_version(), bridge.missing_data(bpy.context.scene)
    more = [app.More([OPTIMIZED], leave)] if searches else []
    return app.run_study(study, args, host=host, more=more, notes=notes)


def export_study(args: argparse.Namespace) -> app.Answer:
    """Write the scene as a study file, with the vehicle's mesh; or for another program."""
    study = opened_study(args.variant)
    is_rig = args.to is not None or args.into is not None or args.output is None
    if is_rig or Path(args.output).suffix in app.SUFFIXES:
        return app.export(study, args)
    path = jobs.prepare_folder(args.output) / studies.STUDY
    jobs.export_study(study, path)
    return str(path), app.DONE


def check_scene_requirements(args: argparse.Namespace) -> app.Answer:
    """Hold the scene to its requirements; the exit status says whether all are met."""
    return app.check_study(opened_study(args.variant), args)


def drive_by_scene(args: argparse.Namespace) -> app.Answer:
    """Drive stories by the scene's rig; the exit status says whether all are confirmed in time."""
    study, path = opened_study(args.variant), Path(args.output or "")
    args.story += args.stories
    if path.suffix not in film.FORMATS:
        return app.drive_by_study(study, args)
    story, *others = app.chosen_stories(study, args.story)
    text.require_new(path, replace=args.replace)
    if others:
        raise pe.InputError("drive-by", "story", "one for a film", 1 + len(others))
    args.output = None
    answer = app.drive_by_study(study, args)
    with quiet_blender():
        film.write_film(bpy.context.scene, study, story, path)
    app.tell(f"wrote {path}")
    return answer


def where_in_scene(args: argparse.Namespace) -> app.Answer:
    """Score one more sensor all over the surface of the scene's vehicle."""
    study, depsgraph = opened_study(args.variant), bpy.context.evaluated_depsgraph_get()
    with from_file():
        study = bridge.with_mount(study, bpy.context.scene, depsgraph, args.mount)
    return app.where(study, args)


def explain_study(args: argparse.Namespace) -> app.Answer:
    """Describe the scene's score as text, or query a location."""
    return app.explain(app.with_options(opened_study(args.variant), args), args)


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
    score = "not scored" if row["entropy"] is None else f"{row['entropy']:.3f} nats"
    old = "  (scored before vehicle, prior or settings changed)" if row["stale"] else ""
    return f"{'*' if row['active'] else ' '} {row['name']}  {score}{old}"


def compare_variants(args: argparse.Namespace) -> app.Answer:
    """Score variants where they are kept, and put them side by side."""
    scene = opened_scene()
    names = args.variants or [row.name for row in scene.perception_entropy.variants]
    by_name = {n: app.with_options(s, args) for n, s in studies_of(scene, names).items()}
    if not by_name:
        raise pe.InputError(bpy.data.filepath, "variants", "at least one", "none")
    return app.compare(by_name, args)


def studies_of(scene: bpy.types.Scene, names: Sequence[str]) -> dict[str, pe.Study]:
    """Return the studies of variants where they are kept, by name."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    with from_file():
        rows = {name: bridge.variant_named(scene, name) for name in names}
        return {n: bridge.study_of_variant(scene, row, depsgraph) for n, row in rows.items()}


def _chosen_studies(variants: list[str]) -> dict[str, pe.Study]:
    """Return the studies by name: of variants, or of what stands in the scene."""
    if not variants:
        return {Path(bpy.data.filepath).stem or "scene": opened_study()}
    return studies_of(opened_scene(), variants)


def review_scene(args: argparse.Namespace) -> app.Answer:
    """Score what stands in the scene, or variants, and write the page."""
    return page.review_studies(_chosen_studies(args.variants), args, bridge.blender_version())
