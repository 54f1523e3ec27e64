"""`pe export` and `pe import`: rigs and scenes of other programs."""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from pe_core.base.errors import InputError, plural
from pe_core.base.files import named_path, quoted, require_new
from pe_core.base.input_files import refuse_input
from pe_core.scene import Pose, Reference, Vehicle, guessed_reference
from pe_core.scoring.sampling import FIRST_SAMPLES
from pe_core.study import STUDY, Study, rig_line, save_study

from ..exchange import (
    FILES,
    SceneFacts,
    export_rig,
    format_of_file,
    format_to_read,
    import_rig,
    read_vehicle_info,
    rig_format,
)
from ..formats import read_mesh
from ..jobs import export_study, prepare_folder, result_dict, score_facts
from ..outputs import OF_EXAMPLE, export_scene, output_files, scene_output, scene_outputs
from .answers import FilesAnswer
from .explain_verbs import scored
from .options import LINE, ranged_outputs
from .run_job import output_file, save_text
from .study_source import StudyFiles
from .terminal import DONE, Answer, answered, tell

FILE_NAMES = {**FILES, **output_files()}
WHEELS = "wheels"  # Asks for the rear axle of the parts that are named as wheels
NO_GUESS = "parts named as wheels, front and rear, to guess the rear axle from"


def export(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Write a study's rig, or its scene, for another program; without a format and a suffix the
    study with the files that it names, into a folder."""
    study = source.study(args)
    if args.to == LINE:
        line = rig_line(study.rig)
        path = output_file(args.output, args)
        status = save_text(path, line)
        is_written = path is not None and status == DONE
        line_file = (str(path),) if is_written else ()
        return answered(args, FilesAnswer(written=line_file, line=line), [line]), status
    if args.output is None and args.into is None:
        args.usage_error("expected -o PATH, a file to write, or --into PATH, one to change")
    output = Path(args.into if args.output is None else args.output)
    if args.to is None and args.into is None and not output.suffix:
        path = prepare_folder(output) / STUDY
        export_study(study, path)
        return answered(args, FilesAnswer(written=(str(path),)), [str(path)]), DONE
    if args.to in OF_EXAMPLE:
        scene_output(args.to)  # refuses it without its plugin
    asked = args.to
    if args.into is not None:
        asked = format_to_read(Path(args.into), args.to)[0].name
    to = format_of_file(output, FILE_NAMES, asked)
    if args.range is not None and to not in ranged_outputs():
        raise InputError("--range", "option", f"one of {', '.join(ranged_outputs())}", to)
    reference = asked_reference(args.rear_axle, study.reference, study.vehicle, to)
    refuse_input(output)
    if to in scene_outputs():
        study = replace(study, reference=reference)
        paths, lines = export_scene(study, to, output, args.range, replace=args.replace)
    else:
        paths, lines = export_rig(
            study.rig,
            to,
            output,
            reference,
            into=args.into,
            placed=asked_origin(args),
            replace=args.replace or args.output is None,
            facts=_facts(source, args, study, to),
        )
    for line in lines:
        tell(line)
    files = tuple(map(str, paths))
    return answered(args, FilesAnswer(written=files), (f"wrote {path}" for path in files)), DONE


def _facts(
    source: StudyFiles, args: argparse.Namespace, study: Study, name: str
) -> SceneFacts | None:
    """Return the vehicle and what a score finds, for a format that has room for them: of the result
    beside the study, if that is still of it, else of a score."""
    row = rig_format(name)
    is_there = args.output is not None and Path(args.output).exists()
    is_refused = (args.into is not None and not row.merges) or (is_there and not args.replace)
    if row.write_scene is None or is_refused:  # `export_rig` says so before anything is scored
        return None
    result = source.stored_result(study, args)
    if result is None:
        result = result_dict(scored(study, None, source))
    return SceneFacts(study.vehicle, score_facts(result))


def import_study(_: StudyFiles, args: argparse.Namespace) -> Answer:
    """Write a study of a rig from the files of another program."""
    if args.output is None:
        args.usage_error("expected -o STUDY, the study to write")
    output = Path(args.output)
    vehicle = None
    if args.mesh is not None:
        mesh = read_mesh(output.parent / args.mesh)
        vehicle = Vehicle(mesh.triangles, mesh.parts, mesh.part_names)
    require_new(output, replace=args.replace)
    reference = asked_reference(args.rear_axle, None, vehicle, args.format or args.file)
    models = chosen_models(args.model)
    found = import_rig(args.file, args.format, reference, models, placed=asked_origin(args))
    study = Study(found.rig, vehicle, samples=FIRST_SAMPLES, mesh=args.mesh, reference=reference)
    require_new(output, replace=args.replace)  # all inputs are read
    save_study(study, output)
    for line in found.lines:
        tell(line)
    return wrote(output, study, args), DONE


def asked_origin(args: argparse.Namespace) -> Pose | None:
    """Return where a file's origin is, as ``--at`` asks for it."""
    return None if args.at is None else Pose.from_degrees(args.at[:3], args.at[3:])


def wrote(output: Path, study: Study, args: argparse.Namespace) -> str:
    """Return what is printed of a study that was written."""
    line = f"wrote {output}: {plural(len(study.rig), 'sensor')}"
    return answered(args, FilesAnswer(written=(str(output),)), [line])


def asked_reference(
    asked: Sequence[str] | None, known: Reference | None, vehicle: Vehicle | None, asking: str
) -> Reference | None:
    """Return the axles: as ``--rear-axle`` asks for them, or else those of the study."""
    if asked is None:
        return known
    if len(asked) == 2:
        x, z = (number_of("--rear-axle", text) for text in asked)
        return Reference(x, z)
    if len(asked) > 2:
        expected = "X Z [m], a file, or wheels"
        raise InputError("command line", "--rear-axle", expected, quoted(" ".join(asked)))
    if asked[0] != WHEELS:
        named_path("command line", "--rear-axle", asked[0])
        return read_vehicle_info(asked[0])
    guess = guessed_reference(vehicle)
    if guess is None:
        raise InputError(asking, "rear axle", NO_GUESS, "none")
    where = f"x {guess.rear_axle_x:g}, z {guess.rear_axle_z:g} m"
    tell(f"rear axle guessed from its wheels: {where}")
    return guess


def number_of(option: str, text: str) -> float:
    """Return the number of an option; `InputError` for another text."""
    try:
        return float(text)
    except ValueError:
        raise InputError("command line", option, "a number", quoted(text)) from None


def chosen_models(texts: Sequence[str]) -> dict[str, str]:
    """Return models by the names of sensors, from texts NAME=MODEL."""
    models = {}
    for text in texts:
        name, _, models[name] = text.partition("=")
        if not (name and models[name]):
            raise InputError("--model", "choice", "NAME=MODEL", quoted(text))
    return models
