"""Details of a score: warnings, explanations, and figures by sensor, zone and class."""

from collections.abc import Iterable, Sequence

from bpy.types import Context, PropertyGroup, UILayout

from ..operators import suggest
from ..panel_text import draw_label, is_simple
from ..queries import body_query, location_query, where_map
from ..queries.diagnostics import explanation
from .layout import BUTTON_PX, draw_sentence, draw_stale_mark, draw_warning, panel, section
from .sensor_lists import draw_sensor_table

PART_SHARE = 0.5
NARROW_PART_SHARE = 0.3


def _warning_count(layout: UILayout, context: Context) -> None:
    count = len(context.scene.perception_entropy.result_warnings)
    if count:
        draw_label(layout, f"{count} warning{'s' if count > 1 else ''}", "ERROR")


@panel("Explain", closed=False, simple=True, preset=_warning_count)
def explain(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Warnings with buttons that fix them; the score in words, by sensor, zone and class"""
    layout.operator("pe.ask_place", icon="EYEDROPPER")  # warnings come late: it stays in its place
    draw_answer(layout, context)
    draw_warnings(layout, settings, context)
    draw_words(layout, settings, context)
    if settings.has_result:
        draw_sensor_table(layout, context)
    if settings.has_result and settings.result.parts and not is_simple(context.scene):
        inside = section(layout, "breakdown", "By Zone and Class")
        if inside is not None:
            draw_breakdown(inside, settings)


def draw_warnings(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Draw a box of warnings for the vehicle and for each sensor that has some."""
    found = settings.result_warnings
    for subject in dict.fromkeys([None, *(warning.subject for warning in found)]):
        own = [warning for warning in found if warning.subject == subject]
        if not own:
            continue
        box = layout.box().column(align=True)
        if subject:
            box.operator("pe.select_object", text=subject, translate=False).name = subject
        for warning in own:
            draw_warning(box, context, warning)


def draw_words(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """Draw the score, and how sure a search is, as sentences."""
    words = explanation(context.scene)
    if words is None:
        return
    draw_lines(layout, settings, context, words.rig)
    if words.search:
        box = layout.box()
        draw_label(box, "How sure the search is")
        draw_lines(box, settings, context, words.search)


def draw_lines(
    layout: UILayout, settings: PropertyGroup, context: Context, lines: Iterable[str]
) -> None:
    """Draw a list of sentences on the last result, grey where it is out of date."""
    column = layout.column(align=True)
    column.active = not settings.result_stale
    for line in lines:
        text = line.strip()
        draw_sentence(column, context, text[:1].upper() + text[1:], icon="DOT")


def draw_answer(layout: UILayout, context: Context) -> None:
    """Draw the answer of the last location query."""
    found = location_query.answer(context.scene)
    if found is None:
        return
    box = layout.box()
    row = box.row()
    lines = row.column(align=True)
    for line in found.lines:
        draw_sentence(lines, context, line, beside_px=BUTTON_PX)
    row.operator("pe.dismiss", text="", icon="X", emboss=False).answer = "QUERY"
    if found.place is not None and not found.place.in_vehicle:
        draw_offers(box, context, point=found.point)


def draw_offers(
    layout: UILayout,
    context: Context,
    requirement: str = "",
    point: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> None:
    """Draw what would fix a requirement, or a place, and buttons that take it."""
    found = where_map.offers.get(context.scene.name)
    if found is None or found.of != (requirement or point):
        button = layout.operator("pe.suggest", icon="TOOL_SETTINGS")
        button.requirement = requirement
        button.point = point
        return
    if not found.found:
        draw_sentence(layout, context, suggest.NONE_FOUND)
    for number, each in enumerate(found.found):
        text = each.sentence
        lines = layout.column()
        draw_sentence(lines, context, text[:1].upper() + text[1:], "GHOST_ENABLED")
        lines.operator(
            "pe.take_suggestion", text="Add It" if each.added else "Move It", icon="CHECKMARK"
        ).number = number


@panel("Surroundings", closed=False)
def surroundings(layout: UILayout, settings: PropertyGroup, context: Context) -> None:
    """A road and test bodies round the vehicle, and which sensors see each body"""
    layout.operator("pe.surroundings", icon="WORLD")
    layout.prop(settings.view, "show_cameras", toggle=True, icon="RENDERLAYERS")
    layout.prop(settings.view, "show_birds_eye", toggle=True, icon="AXIS_TOP")
    for name, body in body_query.seen(context.scene).items():
        column = layout.column(align=True)
        chosen = column.operator(
            "pe.select_object", text=f"{name}: {body.summary}", translate=False
        )
        chosen.name = name
        if context.active_object == context.scene.objects[name]:
            for each in body.seeing:
                draw_part_row(column, each.name, [each.text])


def draw_breakdown(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw entropy and coverage by zone of the ground, and by class of object."""
    result = settings.result
    draw_stale_mark(layout, settings)
    column = layout.box().column(align=True)
    column.active = not settings.result_stale
    for is_class, title in ((False, "Zone"), (True, "Class")):
        has_ap = is_class and bool(result.ap)
        more = ("AP", "ahead") if has_ap else ("ahead",) * is_class
        draw_part_row(column, title, ["nats", "seen", *more], header=True)
        for part in result.parts:
            if part.is_class == is_class:
                more = (part.ap, part.reach) if has_ap else (part.reach,) * is_class
                digits = 0 if has_ap else 1  # four figures have to fit
                nats = f"{part.entropy:.{digits + 1}f}"
                draw_part_row(column, part.name, [nats, f"{part.coverage:.{digits}%}", *more])
        if not is_class:
            column.separator()


def draw_part_row(
    layout: UILayout, name: str, figures: Sequence[str], header: bool = False
) -> None:
    """Draw a row of the table; figures are aligned to the right."""
    split = layout.split(factor=PART_SHARE if len(figures) == 2 else NARROW_PART_SHARE)
    split.active = not header
    draw_label(split, name)
    row = split.row()
    for text in figures:
        cell = row.row()
        cell.alignment = "RIGHT"
        draw_label(cell, text)


CLASSES = (explain, surroundings)
