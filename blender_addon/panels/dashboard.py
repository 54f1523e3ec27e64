"""The dashboard: what the sensors are decided by, what is wanted, and what *Optimize* keeps."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from bpy.types import Context, PropertyGroup, Scene, UILayout

from ..caches.sensor_cache import sensors as listed_sensors
from ..document import NONE, keep_property, limit_property, limits_of, shown_state
from ..engine import advice, scoring, search
from ..live import (
    AT_REST,
    BETTER,
    MOVING,
    OUT_OF_DATE,
    PENDING,
    SAME,
    SENSE_ICONS,
    STORED,
    WORSE,
    ShownScore,
    change_text,
    for_drawing,
    is_not_shown,
    shown_score,
)
from ..operators import known_rigs, shown_verdicts
from ..panel_text import draw_label, is_simple
from .layout import columns, draw_sentence, room_px, shortened_to, text_px

MET_ICONS = {True: "COLORSET_03_VEC", False: "ERROR"}
"""Blender's own green, and its orange triangle."""
NAME_SHARE = 0.39
BESIDE_ROW_PX = 48
LOCK_PX = 20
FIELD_PX = 48
BUTTON_PX = 26
CHANGED_PX = 44
LABEL_PX = 14
LEAST_NAME_PX = 30
"""What is beside a row: borders and tabs; the lock; what a field of what is wanted takes beside its
text, with its mark; the room for the button that wants something or a mark, and beside the text of
what a figure was before; what a label takes beside its text, and the least room for names; all at a
scale of 1."""
LOCKS = {True: "LOCKED", False: "UNLOCKED"}


HEADS = {
    STORED: ("As scored", "CHECKMARK"),
    OUT_OF_DATE: ("Out of date", "FILE_REFRESH"),
    AT_REST: ("Live", "REC"),
    MOVING: ("Live: moving", "REC"),
    PENDING: ("Live: scoring", "REC"),
}
"""What the dashboard is of, by the phase of what is shown."""


def draw_dashboard(layout: UILayout, context: Context) -> None:
    """Draw what is shown of the score, and its figures. Each takes the same rows, those that come
    late included: what is below stays where it is."""
    scene = context.scene
    settings = context.scene.perception_entropy
    if not listed_sensors(scene) and not settings.has_result:
        return
    shown = for_drawing(scene)
    is_stored = shown is not None and shown.stored
    column = layout.box().column(align=True)
    column.active = shown is None or shown.phase != OUT_OF_DATE
    head, wanted = columns(column, 0.66)
    draw_head(head, shown)
    figures = () if shown is None else shown.figures
    before = None if shown is None else shown.before("entropy")
    entropies = [] if shown is None else [shown.entropy]
    entropies = entropies if before is None else [before, *entropies]
    met = [v.met for v in shown_verdicts(scene).values() if v.met is not None]
    rows = search.dashboard(
        figures[-1] if figures else None,
        entropies[-1] if entropies else None,
        met,
        limits_of(settings),
        names=settings.figures,
    )
    judged = [row.met for row in rows if row.met is not None]
    draw_label(wanted, f"{sum(judged)} of {len(judged)} met" if judged else "Wanted")
    errors = {} if shown is None else shown.change_errors()
    drawn = [drawn_row(scene, row, figures, entropies, errors=errors) for row in rows]
    sides = RowWidths.of(context, drawn)
    for each in drawn:
        draw_row(column, context, each, sides)
    if not is_simple(scene):
        name, value = columns(column, NAME_SHARE)
        draw_label(name, "Coverage")
        coverage = "\N{EN DASH}" if shown is None else advice.percent(shown.now.coverage, 1)
        draw_label(value, coverage)
    told = known_rigs.told(scene) if is_stored else ""
    alike = ", ".join(each.name for each in drawn if each.is_noise)
    unsure = f"{alike}: {scoring.NO_DIFFERENCE}" if alike else ""
    draw_label(column, told or unsure or "Score: lower is better")


def draw_result(layout: UILayout, context: Context) -> None:
    """Draw what a stored result says besides its figures: below what has buttons, as it comes
    late."""
    scene = context.scene
    settings = scene.perception_entropy
    shown = shown_score(scene)
    if shown is not None and shown.stored:
        draw_outcome(layout, context)
    if settings.has_result and (state := shown_state(scene)):
        draw_sentence(layout, context, f"Shown: state {state}. Scored: as drawn", icon="INFO")


def draw_head(layout: UILayout, shown: ShownScore | None) -> None:
    """Draw what the dashboard is of, and what its changes are from."""
    text, icon = ("Not scored yet", "BLANK1") if shown is None else HEADS[shown.phase]
    if shown is not None and shown.phase == AT_REST and shown.now.voxels:
        text += f": {shown.now.voxels:,} voxels"
    draw_label(layout, text, icon)


class DrawnRow(NamedTuple):
    """A row as it is drawn: its name, its value, and what that was before, if it has changed.
    `is_noise`: It has changed within the error of that."""

    row: search.Reading
    name: str
    value: str
    before: str
    sense: int
    is_noise: bool

    @property
    def wanted(self) -> str:
        """The text of the field of what is wanted; empty without one."""
        figure = self.row.figure
        is_field = self.row.wanted is not None and figure.rule is not None
        return figure.text(self.row.wanted) if is_field else ""


def drawn_row(
    scene: Scene,
    row: search.Reading,
    figures: Sequence[advice.KeyFigures],
    entropies: list[float],
    errors: Mapping[str, float],
) -> DrawnRow:
    """Return the texts of a row. `errors` are standard errors of changes, by figure."""
    figure = row.figure
    known = [figure.value(each) for each in figures] if figure.is_seen else [row.value]
    values = [value for value in known if value is not None]
    values = entropies if figure.key == search.ENTROPY else values
    is_score = figure.key == search.ENTROPY and is_simple(scene)
    error = errors.get(figure.key, 0.0)
    text, sense = change_text(figure, values, error)
    text = f"{'≥ ' * row.is_cut}{text.removesuffix(' nats' if is_score else ' met')}"
    if row.wanted is not None and figure.rule is None:
        text += f" of {row.wanted:.0f}"
    is_changed = row.wanted is None and sense != SAME
    before = figure.text(values[0]).partition(" ")[0] if is_changed else ""
    name = "Score" if is_score else figure.label
    is_noise = is_not_shown(figure, values, error)
    return DrawnRow(row, name=name, value=text, before=before, sense=sense, is_noise=is_noise)


class RowWidths(NamedTuple):
    """Room for the columns of the dashboard [px]; and whether what figures were before has room,
    too. Figures are never cut: locks give way, then names, which are `text_room` wide, then the
    fields of what is wanted."""

    name: float
    value: float
    wanted: float
    has_room: bool
    has_locks: bool
    has_fields: bool
    text_room: float

    @classmethod
    def of(cls, context: Context, rows: Sequence[DrawnRow]) -> "RowWidths":
        """Return the room that rows have in the sidebar."""
        whole, size = room_px(context, BESIDE_ROW_PX)
        scale = size / context.preferences.ui_styles[0].widget.points
        value = max(text_px(each.value, size) for each in rows) + LABEL_PX * scale
        changes = [text_px(f"({each.before})", size) for each in rows if each.before]
        fields = [text_px(each.wanted, size) + FIELD_PX * scale for each in rows if each.wanted]
        room = whole - LOCK_PX * scale
        gap = LABEL_PX * scale
        short = max(text_px(each.row.figure.short or each.name, size) for each in rows) + gap
        has_fields = whole - value - max(fields, default=0.0) >= short
        least = max([BUTTON_PX * scale, *(fields if has_fields else [])])
        wanted = max([least, *(each + CHANGED_PX * scale for each in changes)])
        has_room = room - value - wanted >= LEAST_NAME_PX * scale
        wanted = wanted if has_room else min(least, max(room - value - gap, gap))
        name = max(text_px(each.name, size) for each in rows) + gap
        has_locks = name <= room - value - least  # also while figures change: rows stay in place
        room = room if has_locks else whole
        name = min(name, max(room - value - wanted, gap))
        return cls(
            name,
            value,
            wanted=wanted,
            has_room=has_room,
            has_locks=has_locks,
            has_fields=has_fields,
            text_room=max(name - gap, 0.0),
        )


def draw_row(layout: UILayout, context: Context, drawn: DrawnRow, sides: RowWidths) -> None:
    """Draw a figure: whether *Optimize* keeps it, its name, its value, and what is wanted."""
    row = drawn.row
    line = layout.row(align=True)
    if sides.has_locks:
        if row.kept or row.wanted is not None or not is_simple(context.scene):
            draw_lock(line, context.scene.perception_entropy, row.figure)
        else:
            line.label(text="", icon="BLANK1")
    total = sides.name + sides.value + sides.wanted
    name, rest = columns(line, sides.name / total, align=True)
    draw_label(name, name_in(context, drawn, sides.text_room))
    value, wanted = columns(rest, sides.value / (sides.value + sides.wanted), align=True)
    draw_label(value, drawn.value)
    wanted = wanted.row(align=True)
    if drawn.before:
        before = f"({drawn.before})" if sides.has_room else ""
        draw_label(wanted, before, SENSE_ICONS[drawn.sense])
    elif row.figure.rule is None or (drawn.wanted and not sides.has_fields):
        wanted.label(text="")
    else:
        draw_wanted(wanted, context.scene, row)
    if row.met is not None:
        wanted.label(text="", icon=MET_ICONS[row.met])


def name_in(context: Context, drawn: DrawnRow, room: float) -> str:
    """Return the name of a figure that fits a room [px]: whole, else short, at last cut."""
    whole = shortened_to(context, drawn.name, room)
    short = drawn.row.figure.short
    return shortened_to(context, short, room) if short and whole != drawn.name else whole


def draw_lock(layout: UILayout, settings: PropertyGroup, figure: search.Figure) -> None:
    """Draw whether *Optimize* keeps a figure."""
    lock = keep_property(figure.key)
    layout.prop(settings, lock, text="", icon=LOCKS[getattr(settings, lock)], emboss=False)


def draw_limits(layout: UILayout, settings: PropertyGroup, now: advice.KeyFigures | None) -> None:
    """Draw the limits on what can be built: the others are in the dashboard. A limit begins with
    the figure that is `now`."""
    column = layout.column(align=True)
    for key in search.BUILD_FIGURES:
        figure = search.FIGURES[key]
        line = column.row(align=True)
        draw_lock(line, settings, figure)
        name, value = columns(line, NAME_SHARE, align=True)
        draw_label(name, figure.label)
        draw_limit(value, settings, figure, figure.value(now))


def draw_wanted(layout: UILayout, scene: Scene, row: search.Reading) -> None:
    """Draw the field of what is wanted; without that, a button that begins with what there is; of
    distances in *Simple* none."""
    is_ring = bool(search.AP_RINGS.get(row.figure.key))
    if is_simple(scene) and is_ring and row.wanted is None:
        return
    draw_limit(layout, scene.perception_entropy, row.figure, row.value)


def draw_limit(
    layout: UILayout, settings: PropertyGroup, figure: search.Figure, now: float | None
) -> None:
    """Draw the field of a limit; without one, a button that begins with the value that is now."""
    name = limit_property(figure.key)
    if getattr(settings, name) > NONE:
        layout.prop(settings, name, text="")
        return
    kind = settings.bl_rna.properties[name].type.lower()
    button = layout.operator(f"wm.context_set_{kind}", text="", icon="ADD")
    button.data_path = f"scene.perception_entropy.{name}"
    button.value = 0 if now is None else figure.begin(now)


def draw_outcome(layout: UILayout, context: Context) -> None:
    """Draw what the last search gained and cost, and what a stored result says besides."""
    scene = context.scene
    settings = context.scene.perception_entropy
    result = settings.result
    column = layout.column(align=True)
    column.active = not settings.result_stale
    sense = BETTER if advice.costs_nothing(result.cost) else WORSE
    for text, mark in ((result.gain, SAME), (result.cost, sense)):
        if text:
            draw_sentence(column, context, text, sense=mark)
    for name, text in (
        ("Expected AP", result.ap),
        ("Mounted Off", result.robustness("rise")),
        ("Sensor Lost", result.robustness("loss")),
    ):
        if text and not is_simple(scene):
            left, right = columns(column, NAME_SHARE)
            draw_label(left, name)
            right.label(text=text, translate=False)
    if text := result.fragile:
        draw_sentence(column, context, text[:1].upper() + text[1:], icon="ERROR")
    for line in result.missing:
        draw_sentence(column, context, f"Scored without it: {line}", icon="ERROR")
