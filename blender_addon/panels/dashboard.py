"""The dashboard: what the sensors are decided by, what is wanted, and what *Optimize* keeps."""

from bpy.types import Context, PropertyGroup, Scene, UILayout

from ..bridge import NONE, Result, keep_property, limit_property, limits_of, shown_state
from ..engine import advice, scoring, search
from ..live import (
    BETTER,
    SAME,
    SENSE_ICONS,
    WORSE,
    change_text,
    is_not_shown,
    shown_score,
    told_figures,
)
from ..operators import known_rigs, shown_verdicts
from ..panel_text import draw_label, is_simple
from ..sensor_cache import sensors as listed_sensors
from .layout import columns, draw_sentence

MET_ICONS = {True: "COLORSET_03_VEC", False: "ERROR"}
"""Blender's own green, and its orange triangle."""
NAME_SHARE = 0.39
VALUE_SHARE = 0.42
SHARE_WITHOUT_UNIT = 0.34
LOCKS = {True: "LOCKED", False: "UNLOCKED"}


def draw_dashboard(layout: UILayout, context: Context) -> None:
    """Draw the live score, or the stored one if it is current or Live is off, and its figures. Each
    takes the same rows, those that come late included: what is below stays where it is."""
    scene = context.scene
    settings = context.scene.perception_entropy
    if not listed_sensors(scene) and not settings.has_result:
        return
    live = shown_score(scene)
    live = None if live is None or live.stored else live
    now = settings.result if live is None else live
    result = settings.result if live is None else None
    column = layout.box().column(align=True)
    column.active = live is not None or not settings.result_stale
    head, wanted = columns(column, 0.66)
    if live is not None:
        sample = f"Live: {live.voxels:,} voxels" if live.voxels else "Live"
        draw_label(head, sample if live.exact else "Live: moving", "REC")
    elif result is None:
        draw_label(head, "Not scored yet", "BLANK1")
    elif settings.result_stale:
        draw_label(head, "Out of date", "FILE_REFRESH")
    else:
        draw_label(head, "As scored", "CHECKMARK")
    figures = [] if now is None else told_figures(scene, live=live is not None)
    entropies = [] if now is None else [now.entropy]
    if result and result.kind == "optimize":
        entropies.insert(0, result.entropy_before)
    met = [v.met for v in shown_verdicts(scene).values() if v.met is not None]
    rows = search.dashboard(
        figures[-1] if figures else None, (entropies or [None])[-1], met, limits_of(settings)
    )
    judged = [row.met for row in rows if row.met is not None]
    draw_label(wanted, f"{sum(judged)} of {len(judged)} met" if judged else "Wanted")
    errors = change_errors(figures, result)
    alike: list[str] = []
    for row in rows:
        known = [row.figure.value(each) for each in figures] if row.figure.is_seen else [row.value]
        known = entropies if row.figure.key == search.ENTROPY else known
        values = [value for value in known if value is not None]
        error = errors.get(row.figure.key, 0.0)
        draw_row(column, scene, row, values, error=error)
        if is_not_shown(row.figure, values, error):
            alike.append(label_in(scene, row.figure))
    if not is_simple(scene):
        name, value = columns(column, NAME_SHARE)
        draw_label(name, "Coverage")
        draw_label(value, "\N{EN DASH}" if now is None else advice.percent(now.coverage, 1))
    told = "" if result is None else known_rigs.told(scene)
    unsure = f"{', '.join(alike)}: {scoring.NO_DIFFERENCE}" if alike else ""
    draw_label(column, told or unsure or "Score: lower is better")
    if result is not None:
        draw_outcome(layout, context)
    if settings.has_result and (state := shown_state(scene)):
        draw_sentence(layout, context, f"Shown: state {state}. Scored: as drawn", icon="INFO")


def change_errors(figures: list[advice.KeyFigures], result: Result | None) -> dict[str, float]:
    """Return the standard errors of the changes that are drawn, by figure: of a stored result, or
    of the live score's figures from those of what it is compared with."""
    if result is not None:
        return result.change_errors
    return figures[-1].errors_from(figures[0]) if len(figures) > 1 else {}


def draw_row(
    layout: UILayout, scene: Scene, row: search.Reading, values: list[float], error: float = 0.0
) -> None:
    """Draw a figure: whether *Optimize* keeps it, its name, its value, and what is wanted. `error`
    is the standard error of its change."""
    settings = scene.perception_entropy
    figure = row.figure
    line = layout.row(align=True)
    draw_lock(line, settings, figure)
    name, rest = columns(line, NAME_SHARE, align=True)
    is_score = figure.key == search.ENTROPY and is_simple(scene)
    draw_label(name, label_in(scene, figure))
    text, sense = change_text(figure, values, error)
    text = f"{'≥ ' * row.is_cut}{text.removesuffix(' nats' if is_score else ' met')}"
    is_changed = row.wanted is None and sense != SAME
    makes_room = is_changed and " " not in text  # for what it was before
    share = SHARE_WITHOUT_UNIT if makes_room else VALUE_SHARE
    value, wanted = columns(rest, share, align=True)
    draw_label(value, text)
    wanted = wanted.row(align=True)
    if is_changed:
        before = figure.text(values[0]).partition(" ")[0]
        draw_label(wanted, f"({before})", SENSE_ICONS[sense])
    elif figure.rule is None:
        wanted.label(text="" if row.wanted is None else f"of {row.wanted:.0f}", translate=False)
    else:
        draw_wanted(wanted, scene, row)
    if row.met is not None:
        wanted.label(text="", icon=MET_ICONS[row.met])


def label_in(scene: Scene, figure: search.Figure) -> str:
    """Return what a figure is called: the entropy is *Score* in *Simple*."""
    return "Score" if figure.key == search.ENTROPY and is_simple(scene) else figure.label


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
    """Draw the field of what is wanted; without that, a button that begins with what there is."""
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
