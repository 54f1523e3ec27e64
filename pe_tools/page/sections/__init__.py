"""The sections of the page, in order: a row each."""

from __future__ import annotations

from collections.abc import Callable

from ..report_context import ReportContext, Section
from ..scene3d import view3d
from .bill_of_materials import bill_of_materials
from .breakdown import by_class_and_zone, objects, sensor_loss
from .comparison import comparison
from .conditions import conditions
from .overview import overview, warnings_and_text
from .redundancy import redundancy
from .requirement_verdicts import requirement_verdicts
from .search_history import search_history
from .sensitivity import sensitivity
from .sensor_details import dimensions, sensor_details
from .traceability import assumptions, rerun
from .visibility import visibility

TOP_SECTIONS: tuple[Callable[[tuple[ReportContext, ...]], Section], ...] = (
    *(overview, comparison, bill_of_materials),
)
"""Sections on all studies together, at the top of the page."""
STUDY_SECTIONS: tuple[Callable[[ReportContext], Section], ...] = (
    *(
        view3d,
        dimensions,
        requirement_verdicts,
        conditions,
        visibility,
        redundancy,
        by_class_and_zone,
        objects,
    ),
    *(sensor_details, sensor_loss, search_history, sensitivity, warnings_and_text, rerun),
)
"""Sections that each study has; several studies stand side by side. Empty ones are left out."""
BOTTOM_SECTIONS: tuple[Callable[[tuple[ReportContext, ...]], Section], ...] = (assumptions,)
"""Sections on all studies together, at the bottom of the page."""

__all__ = ["BOTTOM_SECTIONS", "STUDY_SECTIONS", "TOP_SECTIONS"]
