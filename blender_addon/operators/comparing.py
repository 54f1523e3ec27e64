"""Compare variants: score those that have no score yet in one go, then show a table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from textwrap import wrap
from typing import NamedTuple

import bpy

from .. import bridge, stale
from ..engine import advice, pe
from .job import JobOperator, SceneJob
from .reports import tell

FIGURES_SHARE = 0.1
"""About how much of a score's time its figures take."""
LABEL_PX, COLUMN_PX = 190, 140
LEAST_PX, LETTER_PX = 560, 7
"""Width of the table at least, and of a letter of the sentences above it."""
MOST_COLUMNS = 8
TITLES = {
    "entropy": "Entropy [nats], lower is better",
    "coverage": "Seen of where objects are",
    "ap": "Expected AP",
    "reach": "Reach ahead [m], AP 0.5 or more",
    "blind": "Blind ground [m²], lower is better",
}
WAYS = {"entropy": ".3f", "coverage": ".1%", "ap": ".3f", "reach": ".1f", "blind": ".1f"}
"""How figures of a measure are written."""
WHOLE = "Everywhere"


class ToCompare(NamedTuple):
    """A variant that lacks a score that stands, or figures of the present height and class."""

    name: str
    study: pe.Study
    unscored: bool


class Compared(NamedTuple):
    """What was found of a variant; `score` is None where it has one that stands."""

    score: pe.Score | None
    figures: advice.KeyFigures


class CompareJob:
    """Scores and figures of several studies by a key, in turn; steps and stops as jobs do."""

    def __init__(self, lacking: dict[int, ToCompare], rule: bridge.FigureRule) -> None:
        self.lacking, self.rule = lacking, rule
        self.stopped = self.dropped = False
        self.outcome: dict[int, Compared] | None = None

    def stop(self) -> None:
        """Keep what is complete."""
        self.stopped = True

    def drop(self) -> None:
        """Keep nothing."""
        self.stopped = self.dropped = True

    def __iter__(self) -> Iterator[pe.Progress]:
        found: dict[int, Compared] = {}
        for key, (name, study, unscored) in self.lacking.items():
            score = None
            if unscored:
                job = pe.ScoreJob(study)
                for step in job:
                    if self.stopped:
                        job.stop()
                    yield self._progress(name, len(found), step)
                if job.outcome is None:
                    break
                score = job.outcome.after
            if self.stopped and score is None:
                break
            looking = pe.Progress("seeing", 1.0 - FIGURES_SHARE)
            yield self._progress(name, len(found), looking)
            found[key] = Compared(score, self._figures(study))
        self.outcome = None if self.dropped else found or None

    def _progress(self, name: str, done: int, step: pe.Progress) -> pe.Progress:
        share = (done + step.fraction) / len(self.lacking)
        return replace(step, stage=f"scoring {name}", fraction=min(share, 1.0))

    def _figures(self, study: pe.Study) -> advice.KeyFigures:
        voxels = not study.targets.are_objects
        return advice.key_figures(study.sight(), study.rig, *self.rule, of_voxels=voxels)


class PE_OT_compare_variants(JobOperator, bpy.types.Operator):
    """Put all variants side by side: entropy and coverage by zone and class, blind ground, reach.

    Those without a score, or with one of before, are scored first"""

    bl_idname = "pe.compare_variants"
    bl_label = "Compare"
    bl_options = {"REGISTER", "UNDO"}
    asked_in_window = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not context.scene.perception_entropy.variants:
            cls.poll_message_set("There is no variant yet")
            return False
        return super().poll(context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        if not lacking(context.scene):
            return {"FINISHED"}
        return super().execute(context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Show the table at once where all scores are there."""
        self.asked_in_window = not bpy.app.background
        if self.asked_in_window and not lacking(context.scene):
            return show()
        return super().invoke(context, event)

    def _task(self, context: bpy.types.Context) -> SceneJob:
        scene, depsgraph = context.scene, context.evaluated_depsgraph_get()
        found, refused = {}, []
        for row in lacking(scene):
            try:
                study = bridge.study_of_variant(scene, row, depsgraph)
                found[row.key] = ToCompare(row.name, study, not row.has_result or row.stale)
            except pe.InputError as error:
                refused.append(error)
        if not found:
            raise refused[0]
        for error in refused:
            tell(self, "WARNING", str(error))
        taken = stale.fingerprint(scene, depsgraph)
        rule = bridge.figure_rule(scene, next(iter(found.values())).study.prior)
        self.figures_of = bridge.figures_signature(scene, taken)
        return SceneJob(CompareJob(found, rule), taken)

    def write(
        self, scene: bpy.types.Scene, outcome: dict[int, Compared], taken: bridge.Fingerprint
    ) -> list[str]:
        """Give each variant that still is there its score and its figures."""
        for row in scene.perception_entropy.variants:
            if row.key in outcome:
                score, figures = outcome[row.key]
                if score is not None:
                    bridge.write_score(row, score, taken.surroundings)
                bridge.write_figures(row, figures, self.figures_of)
        if self.asked_in_window:
            show()
        return []

    def message(self, outcome: dict[int, Compared]) -> str:
        """Return the result in a line."""
        scored = sum(each.score is not None for each in outcome.values())
        return f"{scored} scored, {len(outcome)} compared"


class PE_OT_show_comparison(bpy.types.Operator):
    """Show the scores of all variants side by side"""

    bl_idname = "pe.show_comparison"
    bl_label = "Variants Compared"
    bl_options = {"INTERNAL"}

    def execute(self, _context: bpy.types.Context) -> set[str]:
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Work the table out, and open it under the mouse."""
        self.names, self.rows = compared(context.scene)
        width = max(LABEL_PX + COLUMN_PX * len(self.names), LEAST_PX)
        self.said = sentences(self.names, self.rows, width // LETTER_PX)
        return context.window_manager.invoke_popup(self, width=width)

    def draw(self, _context: bpy.types.Context) -> None:
        """Draw it, a column a variant; figures are from the scores that are stored."""
        self.layout.label(text=self.bl_label, icon="MOD_ARRAY")
        said = self.layout.column(align=True)  # first: the table may be taller than the window
        for line in self.said:
            said.label(text=line, translate=False)
        split = self.layout.box().split(factor=LABEL_PX / (LABEL_PX + COLUMN_PX * len(self.names)))
        names, *columns = columns_of(self.names, self.rows)
        draw_column(split.column(align=True), names, "LEFT")
        figures = split.row()
        for column in columns:
            draw_column(figures.column(align=True), column, "RIGHT")
        text = f"A star marks the best; in brackets the difference to {self.names[0]}"
        self.layout.label(text=text, translate=False)


TableCell = tuple[str, bool] | None
"""Text of a cell and whether it is the best; None for a gap."""


def draw_column(column: bpy.types.UILayout, cells: list[TableCell], alignment: str) -> None:
    """Draw a column of the table; a star's room is kept where there is none."""
    other = "BLANK1" if alignment == "RIGHT" else "NONE"
    for cell in cells:
        if cell is None:
            column.separator(factor=0.6)
            continue
        text, best = cell
        row = column.row()
        row.alignment = alignment
        row.label(text=text, icon="SOLO_ON" if best else other, translate=False)


def show() -> set[str]:
    """Open the table."""
    bpy.ops.pe.show_comparison("INVOKE_DEFAULT")
    return {"FINISHED"}


def lacking(scene: bpy.types.Scene) -> list[bpy.types.PropertyGroup]:
    """Variants without a score that stands, or without figures of the present settings."""
    now = stale.fingerprint(scene)
    bridge.check_variants(scene, now)
    of, rows = bridge.figures_signature(scene, now), scene.perception_entropy.variants
    return [
        row for row in rows if not row.has_result or row.stale or bridge.figures_of(row, of) is None
    ]


def compared(
    scene: bpy.types.Scene,
) -> tuple[list[str], tuple[advice.ComparedRow, ...]]:
    """Return the names of the variants that are scored, the active one first, and the table."""
    active = scene.perception_entropy.variant_key
    rows = [row for row in scene.perception_entropy.variants if row.has_result]
    rows = sorted(rows, key=lambda row: row.key != active)[:MOST_COLUMNS]
    scores = {row.name: bridge.score_of(row) for row in rows}
    return list(scores), (*advice.compare(scores), *figure_rows(scene, rows))


def figure_rows(
    scene: bpy.types.Scene, rows: list[bpy.types.PropertyGroup]
) -> tuple[advice.ComparedRow, ...]:
    """Return key figures side by side, where every variant has them."""
    of = bridge.figures_signature(scene, stale.fingerprint(scene))
    figures = {row.name: bridge.figures_of(row, of) for row in rows}
    return () if None in figures.values() else advice.compare_figures(figures)


def sentences(names: list[str], rows: tuple[advice.ComparedRow, ...], letters: int) -> list[str]:
    """Return which variant is best and where, in lines of so many letters."""
    scored = [row for row in rows if row.factor]  # key figures have no error to go by
    said = (*advice.ranking(names, scored), *advice.win_words(names, scored))
    return [line for sentence in said for line in wrap(sentence, letters)]


def columns_of(names: list[str], rows: tuple[advice.ComparedRow, ...]) -> list[list[TableCell]]:
    """Return the table by columns, the first one that of the rows' names."""
    columns: list[list[TableCell]] = [[("", False)], *[[(name, False)] for name in names]]
    for measure, title in TITLES.items():
        if not any(row.measure == measure for row in rows):
            continue
        _add(columns, [(title, False)])
        group = "rig"
        for row in rows:
            if row.measure != measure:
                continue
            if row.group != group:
                _add(columns, [None] * len(columns))
                group = row.group
            label = f"    {row.name.capitalize() or WHOLE}"
            _add(columns, [(label, False), *(_cell(row, k) for k in range(len(names)))])
    return columns


def _add(columns: list[list[TableCell]], cells: list[TableCell]) -> None:
    """Put a row under the table; what is missing at its end is empty."""
    for k, column in enumerate(columns):
        column.append(cells[k] if k < len(cells) else ("", False))


def _cell(row: advice.ComparedRow, k: int) -> TableCell:
    """Return a figure with its difference to the first one, where that can be seen."""
    value, less = row.values[k], row.differences[k]
    if value is None:
        return "–", False
    way = WAYS[row.measure]
    change = "" if less is None else f"{less:+{way}}".removesuffix("%")
    seen = bool(change.strip("+-0."))
    return f"({change})  {value:{way}}" if seen else f"{value:{way}}", row.best[k]


CLASSES = (PE_OT_compare_variants, PE_OT_show_comparison)
