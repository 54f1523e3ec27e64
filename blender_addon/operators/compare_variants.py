"""Compare variants: score those without a valid score in one job, then show a table."""

from collections.abc import Sequence
from textwrap import wrap
from typing import Any, NamedTuple

import bpy

from .. import bridge, result_staleness, variant_pictures
from ..engine import advice, pe
from ..language import draw_label, shown, worded
from ..live import SAME, SENSE_ICONS
from ..own_jobs import ComparedVariant, CompareJob, PendingVariant
from .declared import INTERNAL, OperatorResult, Told, operator
from .jobs import JobRow, Task
from .variants import unless_variants

LABEL_PX, COLUMN_PX = 260, 170
MIN_WIDTH_PX, LETTER_PX = 560, 7
"""Smallest width of the table, and width of a letter of the sentences above it."""
PICTURE_SCALE, BAR_SHARE = 7.0, 0.45
"""Height of a picture in rows, and share of a cell that is its bar."""
MAX_VARIANTS = 8
KEY_FIGURES = ("margin", "sector", "blind", "reach", "ap")
WHOLE_RIG = "Everywhere"
IN_TRAFFIC = ", in traffic"


def compare_task(context: bpy.types.Context) -> Task | None:
    """Read the variants without a valid score or figures; None where all are valid."""
    scene = context.scene
    with bridge.as_drawn(scene):
        bridge.read_states(scene)
        depsgraph = context.evaluated_depsgraph_get()
        pending: dict[int, PendingVariant] = {}
        refused: list[pe.InputError] = []
        for row in pending_variants(scene):
            try:
                study = bridge.study_of_variant(scene, row, depsgraph)
                pending[row.key] = PendingVariant(row.name, study, not row.has_result or row.stale)
            except pe.InputError as error:
                refused.append(error)
        if refused and not pending:
            raise refused[0]
        if not pending:
            return None
        taken = result_staleness.fingerprint(scene, depsgraph)
        figures_of = bridge.figures_signature(scene, taken)

    def finish(scene: bpy.types.Scene, found: dict[int, ComparedVariant]) -> Told:
        for row in scene.perception_entropy.variants:  # those that still exist
            if row.key in found:
                score, figures, picture = found[row.key]
                if score is not None:
                    bridge.store_variant_score(row, score, taken.surroundings)
                bridge.write_figures(row, figures, picture, figures_of)
        scored = sum(variant.score is not None for variant in found.values())
        return Told(f"{scored} scored, {len(found)} compared", tuple(map(str, refused)))

    return Task(CompareJob(pending), finish, "compared")


COMPARE = JobRow(
    "compare_variants",
    "Compare",
    "Compare all variants: entropy and coverage by zone and class, blind ground, reach.\n\n"
    "Variants without a valid score are scored first",
    compare_task,
    unless=unless_variants,
    show=lambda: bpy.ops.pe.show_comparison("INVOKE_DEFAULT"),
).declare()


def _open(self: Any, context: bpy.types.Context, _event: bpy.types.Event) -> OperatorResult:
    """Compute the table, and open it in a window that stays until it is closed."""
    self.names, self.rows = comparison_of(context.scene)
    self.pictures = [bridge.picture_of(row) for row in compared_variants(context.scene)]
    width = max(LABEL_PX + COLUMN_PX * len(self.names), MIN_WIDTH_PX)
    letters = width // LETTER_PX
    self.said = sentences(self.names, self.rows, letters)
    self.said += wrap(bridge.hardware_note(compared_variants(context.scene)), letters)
    title, close = shown(self.bl_label), shown("Close")
    return context.window_manager.invoke_props_dialog(
        self, width=width, title=title, confirm_text=close, translate=False
    )


def _draw(self: Any, context: bpy.types.Context) -> None:
    """Draw figures of the rigs as bars, the scores in words, and the scores by zone and class."""
    _draw_bars(self.layout, self.names, of_rigs(self.rows), self.pictures)
    said = self.layout.column(align=True)
    for line in self.said:
        said.label(text=worded(context.scene, line), translate=False)
    _draw_table(self.layout, self.names, [r for r in self.rows if r.measure not in KEY_FIGURES])
    text = (
        f"A star marks the best; in brackets: the difference to {self.names[0]}, "
        "blue for a gain, orange for a loss"
    )
    draw_label(self.layout, text)


@operator("Variants Compared", options=INTERNAL, invoke=_open, draw=_draw)
def show_comparison(_context: bpy.types.Context) -> None:
    """Show the scores of all variants side by side"""


def of_rigs(rows: Sequence[advice.ComparedRow]) -> list[advice.ComparedRow]:
    """Return what rigs are decided by, that with the largest difference first."""
    whole = [r for r in rows if r.measure in KEY_FIGURES or (r.group, r.name) == ("rig", "")]
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
    share = LABEL_PX / (LABEL_PX + COLUMN_PX * len(names))
    if any(pictures):
        split = lines.split(factor=share)
        split.label(text="")
        cells = _cells(split, names)
        for each in pictures:
            cells.template_icon(variant_pictures.icon_of(each), scale=PICTURE_SCALE)
    for row in [None, *rows]:
        split = lines.split(factor=share)
        label = "The largest difference first" if row is None else label_of(row)
        split.label(text=worded(bpy.context.scene, label), translate=False)
        cells = _cells(split, names)
        for k, name in enumerate(names):
            if row is None:
                cells.label(text=name, translate=False)
                continue
            bar, (text, best, change, sense) = cells.split(factor=BAR_SHARE), _cell(row, k)
            bar.progress(text=text, factor=row.share(k), translate=False)
            draw_label(bar, change, "SOLO_ON" if best else SENSE_ICONS[sense])


def _cells(layout: bpy.types.UILayout, names: list[str]) -> bpy.types.UILayout:
    """Return where the cells of a line go: a column of the same width for each variant."""
    return layout.grid_flow(row_major=True, columns=len(names), even_columns=True)


def label_of(row: advice.ComparedRow) -> str:
    """Return what a bar is of: "Blind ground [m²], 0.5 m tall, within 10 m"."""
    measure, name = row.how.title, row.name.capitalize()
    traffic = IN_TRAFFIC if row.group == advice.TRAFFIC else ""
    return f"{measure}{f', {name}' if name else ''}{traffic}"


def _draw_table(
    layout: bpy.types.UILayout, names: list[str], rows: Sequence[advice.ComparedRow]
) -> None:
    if not rows:
        return
    split = layout.box().split(factor=LABEL_PX / (LABEL_PX + COLUMN_PX * len(names)))
    first, *columns = columns_of(names, rows)
    draw_column(split.column(align=True), first, "LEFT")
    figures = split.row()
    for column in columns:
        draw_column(figures.column(align=True), column, "RIGHT")


class TextCell(NamedTuple):
    """Text of a cell, whether it is the best, and the change from the first column."""

    text: str
    best: bool = False
    change: str = ""
    sense: int = SAME


TableCell = TextCell | None  # None is a gap


def draw_column(column: bpy.types.UILayout, cells: list[TableCell], alignment: str) -> None:
    """Draw a column of the table; every cell reserves the width of a star."""
    other = "BLANK1" if alignment == "RIGHT" else "NONE"
    for cell in cells:
        if cell is None:
            column.separator(factor=0.6)
            continue
        row = column.row(align=True)
        row.alignment = alignment
        if cell.change:
            row.label(text=cell.change, icon=SENSE_ICONS[cell.sense], translate=False)
        text = worded(bpy.context.scene, cell.text) if alignment == "LEFT" else cell.text
        row.label(text=text, icon="SOLO_ON" if cell.best else other, translate=False)


def pending_variants(scene: bpy.types.Scene) -> list[bpy.types.PropertyGroup]:
    """Return variants without a valid score, or without figures of the present settings."""
    fingerprint = result_staleness.fingerprint(scene)
    bridge.check_variants(scene, fingerprint)
    of = bridge.figures_signature(scene, fingerprint)
    rows = scene.perception_entropy.variants
    return [r for r in rows if not r.has_result or r.stale or bridge.figures_of(r, of) is None]


def comparison_of(scene: bpy.types.Scene) -> tuple[list[str], tuple[advice.ComparedRow, ...]]:
    """Return the names of the scored variants, the active one first, and the table's rows. Of key
    figures there are rows if every variant has figures of the present settings."""
    rows = compared_variants(scene)
    scores = {row.name: bridge.score_of(row) for row in rows}
    of = bridge.figures_signature(scene, result_staleness.fingerprint(scene))
    figures = {row.name: bridge.figures_of(row, of) for row in rows}
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


def columns_of(names: list[str], rows: Sequence[advice.ComparedRow]) -> list[list[TableCell]]:
    """Return the table by columns; the first column holds the names of the rows."""
    empty = TextCell("")
    gap: list[TableCell] = [None] * (len(names) + 1)
    table: list[list[TableCell]] = [[empty, *map(TextCell, names)]]
    for key, measure in advice.MEASURES.items():
        found = [row for row in rows if row.measure == key]
        table += [[TextCell(measure.heading), *[empty] * len(names)]] if found else []
        group = "rig"
        for row in found:
            table += [gap] if row.group != group else []
            group = row.group
            traffic = IN_TRAFFIC if row.group == advice.TRAFFIC else ""
            label = TextCell(f"    {row.name.capitalize() or WHOLE_RIG}{traffic}")
            table.append([label, *(_cell(row, k) for k in range(len(names)))])
    return [list(column) for column in zip(*table, strict=True)]


def _cell(row: advice.ComparedRow, k: int) -> TextCell:
    """Return a figure, with its difference to the first variant's if that is not 0."""
    change = row.change_text(k)
    change = f"({change})" if change.strip("+-0.") else ""
    return TextCell(row.text(k), row.best[k], change, row.sense(k))
