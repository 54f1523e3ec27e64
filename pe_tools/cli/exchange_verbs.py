"""`pe export`, `pe import` and `pe rigs`: rigs of other programs and known vehicles."""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pe_core import catalog
from pe_core.base.errors import InputError
from pe_core.base.files import quoted, require_new
from pe_core.base.input_files import refuse_input
from pe_core.catalog import KnownRig, RigTemplate
from pe_core.scene import Pose, Reference, Rig, Vehicle, guessed_reference, named_places
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_core.study import Study, load_study, read_rig_line, rig_line, save_study

from ..exchange import (
    FILES,
    RIG_FORMATS,
    export_rig,
    format_of_file,
    format_to_read,
    import_rig,
    read_vehicle_info,
)
from ..formats import read_mesh
from ..graphics import place_tints
from ..outputs import OF_EXAMPLE, export_scene, output_files, scene_output, scene_outputs
from ..wording import aligned
from .terminal import DONE, Answer, tell


def add_rigs_verb(verbs: Any) -> None:
    """Add ``rigs``: list known rigs and templates, describe one, or write a study of one."""
    parser = verbs.add_parser("rigs", help="list known rigs and templates, or write one as a study")
    about = "a rig's name in the list, or its line"
    parser.add_argument("name", nargs="?", metavar="NAME", help=about)
    about = "print the rig of a study as one line, to send: a study file, and NAME here"
    parser.add_argument("--of", metavar="STUDY", help=about)
    parser.add_argument("-o", "--output", metavar="STUDY", help="study to write")
    about = "the vehicle's mesh, from the study's folder: sensors are stretched onto it"
    parser.add_argument("--mesh", metavar="FILE", help=about)
    standing = parser.add_mutually_exclusive_group()
    about = "leave sensors where they were published, about the vehicle's centre"
    standing.add_argument("--as-published", action="store_true", help=about)
    about = "move each sensor of a known rig to the nearest named place: roof, mirror, bumper"
    standing.add_argument("--on-places", action="store_true", help=about)
    parser.add_argument("--replace", action="store_true", help="replace a study that is there")
    parser.set_defaults(function=show_rigs, usage_error=parser.error)


def show_rigs(args: argparse.Namespace) -> Answer:
    """List known rigs, describe one, or write a study of one; print a study's rig as a line."""
    if args.of is not None:
        if args.name is not None or args.output is not None:
            args.usage_error("expected --of STUDY alone: its line is printed, no study is written")
        return rig_line(load_study(args.of).rig), DONE
    if args.name is None:
        if args.output is not None:
            args.usage_error("expected NAME, a rig to write")
        rows = [["NAME", "SENSORS", "RIG", "VEHICLE"]]
        for each in catalog.known_rigs().values():
            rows.append([each.key, str(len(each.sensors)), each.title, each.vehicle])
        for key, row in catalog.templates().items():
            rows.append([key, str(len(row.sensors)), f"Template: {row.title}", "any"])
        return "\n".join(aligned(rows)), DONE
    if "=" in args.name:
        sensors = read_rig_line(args.name)
        if args.output is None:
            args.usage_error("expected -o STUDY, the study to write")
        output, vehicle = new_study(args)
        study = Study(sensors, vehicle, samples=FIRST_SAMPLES, mesh=args.mesh)
        save_study(study, output)
        return _wrote(output, study), DONE
    rig = catalog.rig_named(args.name)
    if args.output is None:
        return "\n".join(_described(rig)), DONE
    output, vehicle = new_study(args)
    on_it = None if args.as_published else vehicle
    places = named_places(vehicle) if args.on_places and vehicle is not None else None
    placed = catalog.rig_on(rig, on_it, places)
    if isinstance(rig, RigTemplate):
        tints = place_tints((each.name, each.kind) for each in placed)
        placed = Rig([replace(each, color=tints[each.name]) for each in placed])
    study = Study(placed, vehicle, samples=FIRST_SAMPLES, mesh=args.mesh)
    save_study(study, output)
    standing = "as published, about the vehicle's centre"
    if places is not None or isinstance(rig, RigTemplate):
        standing = "on named places of this vehicle"
    elif on_it is not None and rig.size is not None:
        standing = "stretched onto this vehicle's box"
    tell(f"{rig.title}: {standing}. {rig.note}")
    return _wrote(output, study), DONE


def _wrote(output: Path, study: Study) -> str:
    return f"wrote {output}: {len(study.rig)} sensor{'s' if len(study.rig) > 1 else ''}"


def _described(rig: KnownRig | RigTemplate) -> list[str]:
    if isinstance(rig, RigTemplate):
        rows = [["place", "model", "yaw, pitch [deg]"]]
        rows += [[place, model, f"{yaw:g}, {pitch:g}"] for place, model, yaw, pitch in rig.sensors]
        return [rig.title, f"note     {rig.note}", "", *aligned(rows)]
    size = "" if rig.size is None else " {:g} x {:g} x {:g} m".format(*rig.size)
    lines = [rig.title, f"vehicle  {rig.vehicle}{size}", f"origin   {rig.origin}"]
    lines += [f"source   {rig.source}", f"note     {rig.note}", ""]
    rows = [["sensor", "model", "x, y, z [m]", "roll, pitch, yaw [deg]"]]
    for each in rig.sensors:
        place = ", ".join(f"{v:.3f}" for v in each.pose.position)
        turn = ", ".join(f"{v:.3f}" for v in each.pose.rotation_deg)
        rows.append([each.name, each.model, place, turn])
    return lines + aligned(rows)


FILE_NAMES = {**FILES, **output_files()}
SUFFIXES = frozenset(Path(name).suffix for name in FILE_NAMES.values())
"""Suffixes of files that name their format."""
POSE = ("X", "Y", "Z", "ROLL", "PITCH", "YAW")
NO_GUESS = "parts named as wheels, front and rear, to guess the rear axle from"


def add_export_options(
    parser: argparse.ArgumentParser, *, also_study: bool = False, more: Sequence[str] = ()
) -> None:
    """Add the options of ``export`` to a parser. With `also_study`, the default without a format
    and a suffix is to write the study. `more` has additional formats of the caller."""
    known = [*RIG_FORMATS, *dict.fromkeys([*scene_outputs(), *OF_EXAMPLE]), *more]
    default = "by the suffix of PATH" + (", or else a study" if also_study else "")
    about = f"format: {', '.join(known)} (default: {default})"
    parser.add_argument("--to", choices=known, metavar="FORMAT", help=about)
    about = "file, or folder for a format of several files (default: that of --into)"
    parser.add_argument("-o", "--output", metavar="PATH", help=about)
    about = "file that the rig goes into: all that is not about its sensors stays"
    parser.add_argument("--into", metavar="PATH", help=about)
    about = f"of {', '.join(_ranged())}: how far sensors are drawn [m] (default: their range)"
    parser.add_argument("--range", type=float, metavar="M", help=about)
    about = "replace files that are there; what else they hold stays"
    parser.add_argument("--replace", action="store_true", help=about)
    parser.set_defaults(usage_error=parser.error)
    _add_place_options(parser)


def _ranged() -> list[str]:
    """Return the outputs that draw fields of view, as far as asked for."""
    return [row.name for row in scene_outputs().values() if row.has_range]


def add_import_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``import`` to a parser."""
    parser.add_argument("file", metavar="FILE", help="file or folder of another program")
    about = f"its format, if its name does not tell: {', '.join(RIG_FORMATS)}"
    parser.add_argument("--from", dest="format", choices=RIG_FORMATS, metavar="FORMAT", help=about)
    parser.add_argument("-o", "--output", required=True, metavar="STUDY", help="study to write")
    about = "the vehicle's mesh, from the study's folder"
    parser.add_argument("--mesh", metavar="FILE", help=about)
    about = "a sensor's model, which the file does not tell; any number"
    parser.add_argument("--model", action="append", default=[], metavar="NAME=MODEL", help=about)
    parser.add_argument("--replace", action="store_true", help="replace a study that is there")
    _add_place_options(parser)


def _add_place_options(parser: argparse.ArgumentParser) -> None:
    about = "where the file's origin is: x y z in m, roll pitch yaw in degrees"
    parser.add_argument(
        "--at", type=float, nargs=6, metavar=("X", "Y", "Z", "R", "P", "W"), help=about
    )
    where = parser.add_mutually_exclusive_group()
    about = "middle of the rear axle: forward of the origin, above the ground [m]"
    where.add_argument("--rear-axle", type=float, nargs=2, metavar=("X", "Z"), help=about)
    about = "take it from Autoware's vehicle_info.param.yaml"
    where.add_argument("--vehicle-info", metavar="FILE", help=about)
    about = "take it from parts that are named as wheels"
    where.add_argument("--guess-rear-axle", action="store_true", help=about)


def export(study: Study, args: argparse.Namespace) -> Answer:
    """Write a study's rig, or its scene, for another program."""
    if args.to in OF_EXAMPLE:
        scene_output(args.to)  # refuses it without its plugin
    if args.output is None and args.into is None:
        args.usage_error("expected -o PATH, a file to write, or --into PATH, one to change")
    output = Path(args.into if args.output is None else args.output)
    if args.into is not None:
        args.to = format_to_read(Path(args.into), args.to)[0].name
    args.to = format_of_file(output, FILE_NAMES, args.to)
    if args.range is not None and args.to not in _ranged():
        raise InputError("--range", "option", f"one of {', '.join(_ranged())}", args.to)
    reference = _reference(args, study.reference, study.vehicle, args.to)
    refuse_input(output)
    if args.to in scene_outputs():
        study = replace(study, reference=reference)
        paths, lines = export_scene(study, args.to, output, args.range, replace=args.replace)
    else:
        paths, lines = export_rig(
            study.rig,
            args.to,
            output,
            reference,
            into=args.into,
            placed=_pose_at(args),
            replace=args.replace or args.output is None,
        )
    for line in lines:
        tell(line)
    return "\n".join(f"wrote {path}" for path in paths), DONE


def new_study(args: argparse.Namespace) -> tuple[Path, Vehicle | None]:
    """Return the path of the new study, after checks, and the vehicle if there is a mesh."""
    output, vehicle = Path(args.output), None
    if args.mesh is not None:
        mesh = read_mesh(output.parent / args.mesh)
        vehicle = Vehicle(mesh.triangles, mesh.parts, mesh.part_names)
    require_new(output, replace=args.replace)
    return output, vehicle


def import_study(args: argparse.Namespace) -> Answer:
    """Write a study of a rig from the files of another program."""
    output, vehicle = new_study(args)
    reference = _reference(args, None, vehicle, args.format or args.file)
    models = chosen_models(args.model)
    found = import_rig(args.file, args.format, reference, models, _pose_at(args))
    study = Study(found.rig, vehicle, samples=FIRST_SAMPLES, mesh=args.mesh, reference=reference)
    require_new(output, replace=args.replace)  # all inputs are read
    save_study(study, output)
    for line in found.lines:
        tell(line)
    return _wrote(output, study), DONE


def _pose_at(args: argparse.Namespace) -> Pose | None:
    return None if args.at is None else Pose.from_degrees(args.at[:3], args.at[3:])


def _reference(
    args: argparse.Namespace, known: Reference | None, vehicle: Vehicle | None, asking: str
) -> Reference | None:
    """Return the axles: from the options, or else from the study."""
    if args.rear_axle is not None:
        return Reference(*args.rear_axle)
    if args.vehicle_info is not None:
        return read_vehicle_info(args.vehicle_info)
    if not args.guess_rear_axle:
        return known
    guess = guessed_reference(vehicle)
    if guess is None:
        raise InputError(asking, "rear axle", NO_GUESS, "none")
    tell(f"rear axle guessed from its wheels: x {guess.rear_axle_x:g}, z {guess.rear_axle_z:g} m")
    return guess


def chosen_models(texts: Sequence[str]) -> dict[str, str]:
    """Return models by the names of sensors, from texts NAME=MODEL."""
    models = {}
    for text in texts:
        name, _, models[name] = text.partition("=")
        if not (name and models[name]):
            raise InputError("--model", "choice", "NAME=MODEL", quoted(text))
    return models
