"""The sections of the page, in order: a row each. A section is a function from a study (or, if it
is `joint`, from all studies of the page) to the values that its template shows; None leaves it
out."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ...templating import Markup

from .. import scene3d
from ..markup import render
from ..report_context import ReportContext
from .comparison import comparison
from .mounting import as_built, free_regions
from .score import (
    by_class_and_zone,
    conditions,
    flatness,
    objects,
    overview,
    search_history,
    sensor_loss,
    warnings_and_text,
)
from .traceability import assumptions, copy_script, reproduction
from .visibility import drive_by, requirement_verdicts, sensor_details, strip_script, visibility


@dataclass(frozen=True, slots=True)
class Section:
    """A section of the page. `anchor`, `title`: id (lower-case letters and hyphens), which names
    the template, too; and title, plain text. `data`: takes a `ReportContext`, or a tuple of all if
    the section is `joint`; returns the values of the template, or None. ``script_data`` is plain
    JSON, the text of ``#data-ANCHOR-KEY``. `joint`: one section for all studies; several studies
    have the others side by side. `template`: another template. `folded`: closed until it is opened,
    and not printed. Headings begin at h3; ids end in ``-KEY`` of the `ReportContext`. `scripts`:
    returns whole JavaScript programs, of which the page contains each once; a program looks for
    ``[data-section=ANCHOR]``, whose ``data-key`` is KEY."""

    anchor: str
    title: str
    data: Callable[..., Mapping[str, Any] | None]
    joint: bool = False
    template: str = ""
    folded: bool = False
    scripts: Callable[[], Sequence[str]] = tuple

    def html(self, contexts: Sequence[ReportContext], data: Mapping[str, Any]) -> Markup:
        """Return the template with these values, and the studies."""
        template = f"{self.template or self.anchor}.html"
        return render(template, contexts=contexts, context=contexts[0], **data)


SECTIONS = (
    Section("summary", "Summary", overview, joint=True, template="overview"),
    Section("summary", "Comparison", comparison, joint=True, template="comparison"),
    Section("view", "3-D view", scene3d.view, scripts=scene3d.scripts),
    Section("requirements", "Requirements", requirement_verdicts),
    Section("drive-by", "Seen in time", drive_by, scripts=strip_script),
    Section("conditions", "Conditions", conditions, folded=True),
    Section("maps", "Visibility", visibility),
    Section("region", "Where sensors may go", free_regions),
    Section("built", "As built", as_built),
    Section("parts", "By class and zone", by_class_and_zone, folded=True),
    Section("objects", "Objects", objects, folded=True),
    Section("sensors", "Sensors", sensor_details),
    Section("sensor-loss", "Loss of one sensor", sensor_loss, folded=True),
    Section("search", "Search", search_history, folded=True),
    Section("flatness", "How flat the optimum is", flatness, folded=True),
    Section("advice", "Warnings", warnings_and_text, folded=True),
    Section("again", "Reproduction", reproduction, scripts=copy_script, folded=True),
    Section("basis", "Assumptions", assumptions, joint=True, folded=True),
)

__all__ = ["SECTIONS", "Section"]
