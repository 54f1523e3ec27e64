"""Compare variants: score those without a valid score in one job, then show a table."""

from collections.abc import Sequence
from textwrap import wrap
from typing import Any

import bpy
from bpy.props import EnumProperty

from .. import document
from ..caches import result_staleness
from ..engine import advice, pe, search
from ..live import SENSE_ICONS
from ..panel_text import draw_label, worded
from ..processes.own_jobs import ComparedVariant, CompareJob, PendingVariant
from ..view import variant_pictures
from .declared import INTERNAL, OperatorResult, Report, operator
from .jobs import JobRow, Task
from .variants import unless_variants

LABEL_PX = 260
COLUMN_PX = 215
MIN_WIDTH_PX = 560
LETTER_PX = 7
"""Smallest width of the table, and width of a letter of the sentences above it."""
PICTURE_SCALE = 6.0
BAR_SHARE = 0.4
"""Height of a picture in rows, and share of a cell that is its bar."""
MAX_VARIANTS = 8
OF_PARTS = ("entropy", "coverage")  # Figures that zones and classes have as well
WHOLE_RIG = "Everywhere"
WHOLE = "RIG"
PARTS = (
    (WHOLE, "Rig", "Figures that rigs are decided by, and the scores in words"),
    ("PARTS", "By Zone and Class", "Scores by zone and class"),
)
"""What is shown of a comparison: all of it is higher than many windows."""


def compare_task(context: bpy.types.Context) -> Task | None:
    """Read the variants without a valid score or figures; None where all are valid."""
    scene = context.scene
    with document.as_drawn(scene):
        document.read_states(scene)
        depsgraph = context.evaluated_depsgraph_get()
        pending: dict[int, PendingVariant] = {}
        refused: list[pe.InputError] = []
        for row in pending_variants(scene):
            try:
                study = document.study_of_variant(scene, row, depsgraph)
                pending[row.key] = PendingVariant(row.name, study, not row.has_result or row.stale)
            except pe.InputError as error:
                refused.append(error)
        if refused and not pending:
            raise refused[0]
        if not pending:
            return None
        taken = result_staleness.fingerprint(scene, depsgraph)
        figures_of = document.figures_signature(scene, taken)

    def finish(scene: bpy.types.Scene, found: dict[int, ComparedVariant]) -> Report:
        for row in scene.perception_entropy.variants:  # those that still exist
            if row.key in found:
                score, figures, picture = found[row.key]
                if score is not None:
                    document.store_variant_score(row, score, taken.surroundings)
                document.write_figures(row, figures, picture, figures_of)
        scored = sum(variant.score is not None for variant in found.values())
        return Report(f"{scored} scored, {len(found)} compared", tuple(map(str, refused)))

    return Task(CompareJob(pending), finish, "compared")


COMPARE = JobRow(
    name="compare_variants",
    label="Compare",
    about="Compare all variants: entropy and coverage by zone and class, blind ground, reach.\n\n"
    "Variants without a valid score are scored first",
    read=compare_task,
    unless=unless_variants,
    show=lambda: bpy.ops.pe.show_comparison("INVOKE_DEFAULT"),
).declare()


def _open(self: Any, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
    """Compute the table, and open it in a window that stays until it is closed."""
    self.names, self.rows = comparison_of(context.scene)
    self.pictures = [document.picture_of(row) for row in compared_variants(context.scene)]
    width = max(LABEL_PX + COLUMN_PX * len(self.names), MIN_WIDTH_PX)
    letters = width // LETTER_PX
    self.said = sentences(self.names, self.rows, letters)
    worth = document.worth_of_differences(context.scene, compared_variants(context.scene))
    for line in advice.worth_lines(self.names, self.rows, worth):
        self.said += wrap(line, letters)
    self.said += wrap(document.hardware_note(compared_variants(context.scene)), letters)
    return context.window_manager.invoke_props_dialog(
        self, width=width, title=self.bl_label, confirm_text="Close", translate=False
    )


def _draw(self: Any, context: bpy.types.Context) -> None:
    """Draw figures of the rigs as bars and the scores in words, or the scores by zone and class."""
    self.layout.row().prop(self, "part", expand=True)
    if self.part == WHOLE:
        _draw_bars(self.layout, self.names, of_rigs(self.rows), self.pictures)
        said = self.layout.column(align=True)
        for line in self.said:
            said.label(text=worded(context.scene, line), translate=False)
    else:
        _draw_table(self.layout, self.names, [r for r in self.rows if r.measure in OF_PARTS])
    text = (
        f"A star marks the best; in brackets: the difference to {self.names[0]}, "
        "blue for a clear gain, orange for any loss"
    )
    draw_label(self.layout, text)


@operator(
    "Variants Compared",
    options=INTERNAL,
    invoke=_open,
    draw=_draw,
    part=EnumProperty(items=PARTS, name="Show", description="Which figures are shown"),
)
def show_comparison(_context: bpy.types.Context) -> None:
    """Show the scores of all variants side by side"""


def of_rigs(rows: Sequence[advice.ComparedRow]) -> list[advice.ComparedRow]:
    """Return what rigs are decided by, that with the largest difference first."""
    whole = [r for r in rows if r.measure not in OF_PARTS or (r.group, r.name) == ("rig", "")]
    return sorted(whole, key=lambda row: -row.spread)


def _draw_bars(
    layout: bpy.types.UILayout,
    names: list[str],
    rows: Sequence[advice.ComparedRow],
    pictures: Sequence[str] = (),
) -> None:
    """Draw the variants' pictures; below, a row a figure, and in it a bar a variant: its length,
    its figure and the change."""
    lines = layout.box().column(align=True)
    if any(pictures):
        cells = _line(lines, names, "")
        for each in pictures:
            cells.template_icon(variant_pictures.icon_of(each), scale=PICTURE_SCALE)
    _draw_names(lines, names, "The largest difference first")
    for row in rows:
        cells = _line(lines, names, label_of(row))
        for k in range(len(names)):
            _draw_figure(cells, row, k, with_bar=True)


def _draw_table(
    layout: bpy.types.UILayout, names: list[str], rows: Sequence[advice.ComparedRow]
) -> None:
    """Draw a row a zone and class under the heading of each measure."""
    lines = layout.box().column(align=True)
    _draw_names(lines, names, "")
    for figure in search.FIGURES.values():
        found = [row for row in rows if row.how is figure]
        if found:
            _line(lines, names, figure.heading)
        for row, last in zip(found, [*found[:1], *found], strict=False):
            if row.group != last.group:
                lines.separator(factor=0.6)
            cells = _line(lines, names, f"    {row.name.capitalize() or WHOLE_RIG}")
            for k in range(len(names)):
                _draw_figure(cells, row, k)


def _line(lines: bpy.types.UILayout, names: list[str], label: str) -> bpy.types.UILayout:
    """Draw a line's label; return where its cells go: a column of the same width a variant."""
    split = lines.split(factor=LABEL_PX / (LABEL_PX + COLUMN_PX * len(names)))
    split.label(text=worded(bpy.context.scene, label), translate=False)
    return split.grid_flow(row_major=True, columns=len(names), even_columns=True)


def _draw_names(lines: bpy.types.UILayout, names: list[str], label: str) -> None:
    cells = _line(lines, names, label)
    for name in names:
        cells.label(text=name, translate=False)


def _draw_figure(
    cells: bpy.types.UILayout, row: advice.ComparedRow, k: int, *, with_bar: bool = False
) -> None:
    """Draw a figure, and beside it the change with a star or a colour."""
    cell = cells.split(factor=BAR_SHARE)
    text, best, change, sense = cell_of(row, k)
    if with_bar:
        cell.progress(text=text, factor=row.share(k), translate=False)
    else:
        cell.label(text=text, translate=False)
    draw_label(cell, change, "SOLO_ON" if best else SENSE_ICONS[sense])


def label_of(row: advice.ComparedRow) -> str:
    """Return what a bar is of: "Blind ground [m²], 0.5 m tall, within 10 m"."""
    traffic = advice.TRAFFIC if row.group == advice.TRAFFIC else ""
    return ", ".join(filter(None, (row.how.title, row.name.capitalize(), traffic)))


def cell_of(row: advice.ComparedRow, k: int) -> tuple[str, bool, str, int]:
    """Return a figure, whether it is the best, its difference to the first variant's if that is not
    0, and whether this is a gain or a loss."""
    change = row.change_text(k, "\N{PLUS-MINUS SIGN}")
    change = f"({change})" if change.strip("+-0.") else ""
    return row.text(k), row.best[k], change, row.sense(k)


def pending_variants(scene: bpy.types.Scene) -> list[bpy.types.PropertyGroup]:
    """Return variants without a valid score, or without figures of the present settings."""
    fingerprint = result_staleness.fingerprint(scene)
    document.check_variants(scene, fingerprint)
    of = document.figures_signature(scene, fingerprint)
    rows = scene.perception_entropy.variants
    return [r for r in rows if not r.has_result or r.stale or document.figures_of(r, of) is None]


def comparison_of(scene: bpy.types.Scene) -> tuple[list[str], tuple[advice.ComparedRow, ...]]:
    """Return the names of the scored variants, the active one first, and the table's rows. Of key
    figures there are rows if every variant has figures of the present settings."""
    rows = compared_variants(scene)
    scores = {row.name: document.score_of(row) for row in rows}
    of = document.figures_signature(scene, result_staleness.fingerprint(scene))
    figures = {row.name: document.figures_of(row, of) for row in rows}
    known = {name: each for name, each in figures.items() if each is not None}
    more = advice.compare_figures(known) if len(known) == len(figures) else ()
    return list(scores), (*advice.compare(scores), *more)


def compared_variants(scene: bpy.types.Scene) -> list[bpy.types.PropertyGroup]:
    """Return the scored variants that the table has room for, the active one first."""
    active = scene.perception_entropy.variant_key
    rows = [row for row in scene.perception_entropy.variants if row.has_result]
    return sorted(rows, key=lambda row: row.key != active)[:MAX_VARIANTS]


def sentences(names: list[str], rows: tuple[advice.ComparedRow, ...], letters: int) -> list[str]:
    """Return sentences on the best variant by row, wrapped into lines of `letters` letters."""
    scored = [row for row in rows if row.factor and row.group != advice.TRAFFIC]
    apart = advice.disagreement(names, rows)
    lines = (apart, *advice.ranking(names, scored))
    return [line for sentence in lines if sentence for line in wrap(sentence, letters)]
