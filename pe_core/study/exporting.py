"""A study as a set of files that run anywhere: its TOML, and the meshes and boxes it names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ..formats.boxes import write_boxes
from ..formats.meshes import Mesh, write_mesh
from .folder import FileSet, Write
from .mounting_file import areas_mesh, with_areas_in
from .names import AREAS, BOXES, MESH, STUDY
from .study import Study
from .study_file import study_bytes


def export_study(study: Study, path: str | Path, *, replace_study: bool = False) -> None:
    """Write a study with its vehicle's mesh, areas and boxes side by side, to run anywhere.

    Parameters
    ----------
    study : Study
    path : path
        Of the study file; mesh, areas and boxes are named after it.
    replace_study : bool
        The user has agreed to replace the file at `path`, whoever wrote it. This does not go for
        the files beside it.

    Raises
    ------
    InputError
        A file is there that was not written by this program, or changed since, or one cannot be
        written: then none is.
    """
    path = Path(path)
    with FileSet(path.parent, (path.name,) if replace_study else ()) as files:
        for name, write in study_writers(study, path.name).items():
            files.add(name, write)


def study_writers(study: Study, name: str) -> dict[str, Write | bytes]:
    """Return what writes a study file of this name, and the files beside it, by name."""
    path, writers = Path(name), dict[str, Write | bytes]()
    if study.vehicle is not None:
        vehicle = study.vehicle
        mesh = Mesh(vehicle.triangles, np.asarray(vehicle.parts), tuple(vehicle.part_names))
        study = study.with_mesh(MESH if name == STUDY else path.with_suffix(".npz").name)
        writers[str(study.mesh)] = lambda at: write_mesh(at, mesh)
    search = study.search
    if (areas := areas_mesh(search.mounting)) is not None:
        file = AREAS if name == STUDY else path.with_suffix(f".{AREAS}").name
        writers[file] = lambda at: write_mesh(at, areas)
        search = replace(search, mounting=with_areas_in(search.mounting, file))
        study = replace(study, search=search)
    if (boxes := study.prior.boxes) is not None:
        table = BOXES if name == STUDY else path.with_suffix(f".{BOXES}").name
        writers[table] = lambda at: write_boxes(at, boxes)
        named = replace(boxes, file=table, origin=None)
        study = replace(study, prior=replace(study.prior, boxes=named))
    writers[name] = study_bytes(study)
    return writers
