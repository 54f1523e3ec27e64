"""What tells one study from another: all that scores and searches follow from, in short."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from .. import catalog
from .exporting import study_writers
from .mounting_file import areas_of
from .names import STUDY
from .study import Study


def fingerprint(study: Study) -> str:
    """Return a SHA-256 of a study: of its values, not of the names of its files.

    Two studies that have the same one give the same scores and the same search, to the bit.
    """
    seen = hashlib.sha256()
    for part in _parts(study):
        seen.update(len(part).to_bytes(8, "little") + part)
    return seen.hexdigest()


def _parts(study: Study) -> Iterator[bytes]:
    written = study_writers(replace(study, passthrough=None), STUDY)[STUDY]
    assert isinstance(written, bytes)
    yield written
    yield json.dumps([catalog.to_table(sensor.model) for sensor in study.rig]).encode()
    if (vehicle := study.vehicle) is not None:
        yield np.ascontiguousarray(vehicle.triangles).tobytes()
        yield np.ascontiguousarray(vehicle.parts).tobytes()
        yield json.dumps(list(vehicle.part_names)).encode()
    for name, area in areas_of(study.search.mounting).items():
        yield name.encode() + np.ascontiguousarray(area.triangles).tobytes()
    if (boxes := study.prior.boxes) is not None:
        yield boxes.digest.encode()
