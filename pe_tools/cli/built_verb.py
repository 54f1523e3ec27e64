"""`pe compare DESIGN BUILT`: the built rig in a file of another program against the design."""

import argparse
import signal
from collections.abc import Mapping
from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.study import Study

from .. import advice
from ..advice import AsBuilt
from ..exchange import import_rig
from ..jobs import BuiltJob
from ..wording import aligned
from .answers import BuiltAnswer
from .exchange_verbs import asked_origin, asked_reference
from .explain_verbs import compare, comparison
from .interrupts import Interrupted, stop_at_first
from .run_job import drive, print_vehicle
from .study_source import StudyFiles
from .terminal import DONE, NOT_MET, Answer, answered

TOML = ".toml"


def compare_all(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Compare studies; a rig of another program is the built one of the first study."""
    file = _built_file(args)
    return compare(source, args) if file is None else compare_built(source, args, file)


def _built_file(args: argparse.Namespace) -> str | None:
    """Return the file of a built rig: of the option, or the second of two names that is no study's.
    It is taken off the studies then."""
    named: list[str] = getattr(args, "studies", [])
    if args.built is None and len(named) == 2 and Path(named[1]).suffix.lower() != TOML:
        args.built = named.pop()
    file: str | None = args.built
    return file


def compare_built(source: StudyFiles, args: argparse.Namespace, file: str) -> Answer:
    """Compare a built rig of another program's file with the designed one of a study."""
    studies: Mapping[str, Study] = source.studies(args)
    if len(studies) != 1:
        raise InputError("command line", "STUDY", "one study, the design", len(studies))
    built = found_built(next(iter(studies.values())), args, file)
    table = advice.built_table(built)
    text = [*aligned(table, range(2, len(table[0]))), *advice.built_sensor_lines(built), ""]
    text += comparison(["design", "built"], built.of_rigs)
    answer = answered(args, BuiltAnswer(as_built=built.to_dict()), text)
    return answer, NOT_MET if built.fallen else DONE


def found_built(study: Study, args: argparse.Namespace, file: str) -> AsBuilt:
    """Return the comparison of a study with the built rig in a file; Ctrl-C ends it."""
    reference = asked_reference(args.rear_axle, study.reference, study.vehicle, file)
    found = import_rig(file, args.format, reference, placed=asked_origin(args))
    print_vehicle(study)
    job = BuiltJob(study, found.rig, found.lines_without_models, args.workers)
    with stop_at_first(job.stop) as received:
        built = drive(job)
    if built is None:
        raise Interrupted(received.signum or signal.SIGINT, "no comparison was complete")
    return built
