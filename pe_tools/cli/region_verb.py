"""`pe region`: where a sensor may go while a figure loses at most an amount."""

import argparse
from pathlib import Path

import numpy as np

from pe_core.base import dump_json
from pe_core.base.errors import InputError
from pe_core.base.files import write_bytes
from pe_core.base.table_reader import finite
from pe_core.scene.mesh import Mesh
from pe_core.study import Study

from ..advice import FreeRegion, region_lines
from ..formats.meshes import MESH_FORMATS, write_mesh
from ..jobs import RegionJob, export_study, study_on_region
from .answers import RegionAnswer
from .interrupts import Interrupted, stop_at_first
from .run_job import drive, output_file, print_vehicle, written
from .study_source import StudyFiles
from .terminal import BAD_INPUT, DONE, Answer, answered, tell

JSON = ".json"
STUDY = ".toml"


def region(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Find the free region of a sensor; write its patch, its data, or the next study on it."""
    study = source.study(args)
    path = output_file(args.output, args)
    _check_suffix(path)
    print_vehicle(study)
    job = RegionJob(
        study,
        args.sensor,
        args.figure,
        allowed=args.loss,
        count=args.places,
        search_others=args.others,
        workers=args.workers,
    )
    found, status = _driven(job)
    text = answered(args, RegionAnswer(**found.to_dict()), region_lines(found))
    unwritten = _save(path, study, found)
    return text, unwritten or status


def found_region(study: Study, sensor: str, workers: int | None) -> FreeRegion:
    """Return the free region of a sensor, with progress; Ctrl-C ends it with what is known."""
    return _driven(RegionJob(study, sensor, workers=workers))[0]


def _driven(job: RegionJob) -> tuple[FreeRegion, int]:
    """Run a job; return its region and the exit status."""
    with stop_at_first(job.stop) as received:
        drive(job)
    if job.result is None:
        raise Interrupted(received.signum or 2, "no place was scored")
    return job.result, received.status(DONE)


def _check_suffix(path: Path | None) -> None:
    known = [JSON, STUDY, *(suffix for suffix, row in MESH_FORMATS.items() if row.write)]
    if path is not None and path.suffix not in known:
        raise InputError(path, "suffix", " ".join(known), path.suffix or "none")


def _save(path: Path | None, study: Study, found: FreeRegion) -> int:
    """Write a region to the file of a command, if it has one; return the exit status of that."""
    if path is None:
        return DONE
    if not written(lambda to: _write(to, study, found), path):
        return BAD_INPUT
    tell(f"wrote {path}")
    return DONE


def _write(path: Path, study: Study, found: FreeRegion) -> None:
    if path.suffix == JSON:
        write_bytes(path, f"{dump_json(finite(found.to_dict()))}\n".encode())
    elif path.suffix == STUDY:
        export_study(study_on_region(study, found), path, replace_study=True)
    else:
        patch = found.patch
        if not len(patch):
            raise InputError(path, "patch", "a region with an area", "none")
        name = f"{found.sensor} region"
        write_mesh(path, Mesh(patch, np.zeros(len(patch), np.int32), (name,)))
