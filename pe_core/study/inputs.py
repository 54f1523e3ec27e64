"""What a run was given, as result.json tells it."""

from __future__ import annotations

from typing import Any

from ..text.json_text import finite
from .fingerprint import fingerprint
from .study import Study, vehicle_digest
from .study_file import study_to_dict


def inputs_of(study: Study) -> dict[str, Any]:
    """Return a study and its vehicle as plain JSON data, with its files called as it calls them."""
    data: dict[str, Any] = finite(
        {
            "study": study_to_dict(study),
            "study_sha256": fingerprint(study),
            "vehicle": study.vehicle_line,
            "vehicle_triangles": 0 if study.vehicle is None else len(study.vehicle.triangles),
            "vehicle_sha256": vehicle_digest(study.vehicle),
        }
    )
    return data
