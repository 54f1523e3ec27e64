"""The verbs of the scene's own study: score, optimize, export, explain."""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

from .. import bridge
from ..engine import app, pe, studies
from .leaving import OPTIMIZED, REVIEW, leave_front, leave_scene
from .opened import from_file, opened_study
from .plain_objects import OBJECTS, export_objects
from .streams import quiet_blender


def run_job(args: argparse.Namespace) -> app.Answer:
    """Score or optimize, and leave the results in the output folder."""
    study, kind = app.with_options(opened_study(args.variant), args), args.kind
    if kind == "optimize" and study.selection.choices:
        return choose_sensors(study, args)
    if kind == "optimize":
        with from_file():
            bridge.check_placeable(bpy.context.scene, study)
    job, output = app.job_and_folder(study, args, app.begun_search(args))
    ours = [OPTIMIZED] * (kind == "optimize") + [REVIEW] * args.render

    def leave(outcome: pe.Outcome, data: dict, folder: Path) -> None:
        with quiet_blender():
            leave_scene(outcome, data, folder, render=args.render)

    more = app.with_pages(args, app.More(ours, leave))
    if output is not None:
        output = pe.prepare_folder(output, [*more.names, *studies.result_names(study, kind)])
    job.notes = bridge.missing_pieces(bpy.context.scene)
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
            leave_front(found, folder)

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
