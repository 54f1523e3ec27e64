"""Write a study with all files that it refers to; compute its fingerprint and provenance."""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from pe_core import catalog
from pe_core.base.table_reader import finite
from pe_core.prior.grid import grid_bytes
from pe_core.scene.rig import Rig
from pe_core.study.file_names import AREAS, BOXES, GRID, MESH, STUDY
from pe_core.study.mounting_file import areas_mesh, areas_of, with_areas_in
from pe_core.study.study import Study
from pe_core.study.study_file import study_bytes, study_to_dict

from .. import formats
from .folder import FileSet, Write


def export_study(
    study: Study, path: str | Path, *, replace_study: bool = False, with_mesh: bool = True
) -> None:
    """Write a portable study: the study file, and the files that it names beside it.

    Parameters
    ----------
    study : Study
    path : path
        Of the study file; the others are named after it.
    replace_study : bool
        Whether the user has agreed to replace the file at `path`, even one that this program did
        not write. This does not apply to the files beside it.
    with_mesh : bool
        Whether the vehicle's mesh is written, too; without it the study is read again only together
        with a vehicle.

    Raises
    ------
    InputError
        A file exists that this program did not write or that was changed since, or a file cannot be
        written. No file is written then.
    """
    path = Path(path)
    with FileSet(path.parent, (path.name,) if replace_study else ()) as files:
        for name, write in study_writers(study, path.name, with_mesh=with_mesh).items():
            files.add(name, write)


def study_writers(study: Study, name: str, *, with_mesh: bool = True) -> dict[str, Write | bytes]:
    """Return the content of a study file, and writers of the files beside it, by file name."""
    path = Path(name)
    writers = dict[str, Write | bytes]()
    if study.vehicle is not None:
        vehicle = study.vehicle
        mesh = formats.Mesh(vehicle.triangles, np.asarray(vehicle.parts), tuple(vehicle.part_names))
        study = study.with_mesh(MESH if name == STUDY else path.with_suffix(".npz").name)
        if with_mesh:
            writers[str(study.mesh)] = lambda at: formats.write_mesh(at, mesh)
    search = study.search
    if (areas := areas_mesh(search.mounting)) is not None:
        file = AREAS if name == STUDY else path.with_suffix(f".{AREAS}").name
        writers[file] = lambda at: formats.write_mesh(at, areas)
        search = replace(search, mounting=with_areas_in(search.mounting, file))
        study = replace(study, search=search)
    if (boxes := study.prior.boxes) is not None:
        table = BOXES if name == STUDY else path.with_suffix(f".{BOXES}").name
        writers[table] = lambda at: formats.write_boxes(at, boxes)
        named = replace(boxes, file=table, origin=None)
        study = replace(study, prior=replace(study.prior, boxes=named))
    if (grid := study.prior.grid) is not None:
        file = GRID if name == STUDY else path.with_suffix(f".{GRID}").name
        writers[file] = grid_bytes(grid)
        study = replace(study, prior=replace(study.prior, grid=replace(grid, file=file)))
    writers[name] = study_bytes(study)
    return writers


def study_text(study: Study) -> str:
    """Return the text of a study's file as `study_writers` has it."""
    written = study_writers(study, STUDY)[STUDY]
    assert isinstance(written, bytes)
    return written.decode()


def fingerprint(study: Study) -> str:
    """Return the SHA-256 of the values of a study; the names of its files, the colours of its
    sensors, and the edges from which positions are told do not count. Two studies with the same
    fingerprint give the same scores and the same search, to the bit."""
    digest = hashlib.sha256()
    for part in _parts(study):
        digest.update(len(part).to_bytes(8, "little") + part)
    return digest.hexdigest()


def _parts(study: Study) -> Iterator[bytes]:
    plain = Rig([replace(sensor, color=None, measured_from={}) for sensor in study.rig])
    yield study_text(replace(study, rig=plain, edges=())).encode()
    yield json.dumps([catalog.to_table(sensor.model) for sensor in study.rig]).encode()
    if (vehicle := study.vehicle) is not None:
        yield np.ascontiguousarray(vehicle.triangles).tobytes()
        yield np.ascontiguousarray(vehicle.parts).tobytes()
        yield json.dumps(list(vehicle.part_names)).encode()
    for name, area in areas_of(study.search.mounting).items():
        yield name.encode() + np.ascontiguousarray(area.triangles).tobytes()
    if (boxes := study.prior.boxes) is not None:
        yield boxes.digest.encode()
    if study.prior.grid is not None:
        yield study.prior.grid.digest.encode()


def inputs_of(study: Study) -> dict[str, Any]:
    """Return the provenance of a result as plain JSON data: study, fingerprint, vehicle."""
    data: dict[str, Any] = finite(
        {
            "study": study_to_dict(study),
            "study_sha256": fingerprint(study),
            "vehicle": study.vehicle_line,
            "vehicle_triangles": 0 if study.vehicle is None else len(study.vehicle.triangles),
        }
    )
    return data
