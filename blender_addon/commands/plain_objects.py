"""Blender's own cameras and empties on the command line: a study of them, a .blend with them."""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

from .. import bridge
from ..engine import app, catalog, exchange, pe, search
from .leaving import save_copy
from .opened import from_file

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
        study = _study(scene, pe.Rig(found))
    pe.export_study(study, output, replace_study=args.replace)
    for line in lines:
        app.tell(line)
    return f"wrote {output}: {len(found)} sensor{'s' if len(found) > 1 else ''}", app.DONE


def _study(scene: bpy.types.Scene, rig: pe.Rig) -> pe.Study:
    if scene.perception_entropy.vehicle is None:
        return pe.Study(rig, reference=bridge.reference_of(scene.perception_entropy))
    free = {sensor.name: search.PAPER_FREE for sensor in rig}
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return bridge.study_of_rig(scene, depsgraph, rig, free, limits={})


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
