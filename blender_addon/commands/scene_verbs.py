"""Verbs of the scene: score, optimize, export, explain, and import of Blender's own objects."""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

from .. import bridge
from ..engine import app, catalog, exchange, jobs, pe, studies
from .open_file import (
    OPTIMIZED,
    REVIEW,
    from_file,
    opened_study,
    save_copy,
    write_artifacts,
    write_front,
)
from .streams import quiet_blender

OBJECTS, LIDAR = "blender", "lidar"


def add_objects_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``import`` to a parser."""
    parser.add_argument("-o", "--output", required=True, metavar="STUDY", help="study to write")
    about = "an object's model, for those that say none; any number"
    parser.add_argument("--model", action="append", default=[], metavar="NAME=MODEL", help=about)
    parser.add_argument("--replace", action="store_true", help="replace a study that is there")
    parser.set_defaults(function=import_objects)


def import_objects(args: argparse.Namespace) -> app.Answer:
    """Write a study of the scene's vehicle, with its cameras and empties as the sensors."""
    scene, output = bpy.context.scene, Path(args.output)
    if output.exists() and not args.replace:
        raise pe.InputError(output, "file", "a new file (or --replace)", "one is there")
    with from_file():
        models = app.chosen_models(args.model)
        for model in models.values():
            catalog.load(model)
        stand_in = exchange.STAND_INS[LIDAR]
        found, lines = bridge.sensors_of_objects(scene, scene.objects, models, stand_in)
        study = _study_of_rig(scene, pe.Rig(found))
    pe.export_study(study, output, replace_study=args.replace)
    for line in lines:
        app.tell(line)
    return f"wrote {output}: {len(found)} sensor{'s' if len(found) > 1 else ''}", app.DONE


def _study_of_rig(scene: bpy.types.Scene, rig: pe.Rig) -> pe.Study:
    if scene.perception_entropy.vehicle is None:
        return pe.Study(rig, reference=bridge.reference_of(scene.perception_entropy))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return bridge.study_of_rig(scene, depsgraph, rig)


def export_objects(study: pe.Study, args: argparse.Namespace) -> app.Answer:
    """Save the scene to another file, with a camera or an empty for each sensor."""
    path = Path(args.output)
    if path.exists() and not args.replace:
        raise pe.InputError(path, "file", "a new file (or --replace)", "one is there")
    _, lines = bridge.put_objects(bpy.context.scene, study.rig)
    save_copy(path)
    for line in lines:
        app.tell(line)
    return f"wrote {path}", app.DONE


def run_job(args: argparse.Namespace) -> app.Answer:
    """Score or optimize, and leave the results in the output folder."""
    study, kind = app.with_options(opened_study(args.variant), args), args.kind
    if kind == "optimize" and study.selection.choices:
        return choose_sensors(study, args)
    if kind == "optimize":
        with from_file():
            bridge.check_placeable(bpy.context.scene, study)
    job, name = app.job_and_folder(study, args, app.begun_search(args))
    ours = [OPTIMIZED] * (kind == "optimize") + [REVIEW] * args.render

    def leave(outcome: pe.Outcome, data: dict, folder: Path) -> None:
        with quiet_blender():
            write_artifacts(outcome, data, folder, render=args.render)

    more = app.with_pages(args, app.More(ours, leave))
    output = None
    if name is not None:
        names = [*(more.names if more else ()), *jobs.result_names(study, kind)]
        output = pe.prepare_folder(name, names)
    job.notes = bridge.missing_data(bpy.context.scene)
    return app.carry_out(
        job,
        output,
        as_json=args.json,
        host=bridge.blender_version(),
        more=more,
    )


def choose_sensors(study: pe.Study, args: argparse.Namespace) -> app.Answer:
    """Search for the front of a scene with choices; its designs are variants of the new scene."""
    scene, output = bpy.context.scene, None
    app.check_not_resumed(args)
    with from_file():
        bridge.check_choosable(scene, study)
    if args.output is not None:
        output = pe.prepare_folder(args.output, [OPTIMIZED])

    def leave(found: pe.TradeOff, folder: Path) -> None:
        with quiet_blender():
            write_front(found, folder)

    job, host = pe.ChoiceJob(study, args.workers), bridge.blender_version()
    return app.choose(job, output, as_json=args.json, host=host, more=leave)


def export_study(args: argparse.Namespace) -> app.Answer:
    """Write the scene as a study file, with the vehicle's mesh; or for another program."""
    study = opened_study(args.variant)
    if args.to == OBJECTS:
        return export_objects(study, args)
    if args.to is not None:
        return app.export(study, args)
    path = pe.prepare_folder(args.output) / studies.STUDY
    pe.export_study(study, path)
    return str(path), app.DONE


def explain_study(args: argparse.Namespace) -> app.Answer:
    """Tell the scene's score in words, or ask a place."""
    return app.explain(app.with_options(opened_study(args.variant), args), args)
