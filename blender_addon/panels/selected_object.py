"""Settings of the selected object: a sensor, or a part of the vehicle."""

from bpy.types import Context, Object, PropertyGroup, UILayout

from ..document import holder_of, in_surroundings
from ..engine import search
from ..operators import shown_way
from ..panel_text import draw_label, is_simple, worded
from ..properties import AXIS_LABELS, measured_distances
from ..queries import where_map
from ..sensor_kinds import has_view
from .layout import draw_declared, draw_sentence, panel, section

EDGE_SHARE = 0.5  # Room for an edge's name beside the distance from it
POSITION_LABELS = ("X", "Y", "Height")
"""Height is z of the optical centre over the ground."""


def _sensor_is_shown(context: Context) -> bool:
    obj = context.active_object
    return obj is not None and obj.perception_entropy.is_sensor


@panel("Sensor", simple=True, closed=False, poll=_sensor_is_shown)
def sensor(layout: UILayout, _settings: PropertyGroup, context: Context) -> None:
    """Settings of the sensor that is selected"""
    obj = context.active_object
    settings = obj.perception_entropy
    layout.prop(settings, "model")
    if not is_simple(context.scene):
        layout.prop(settings, "fusion")
    draw_pose(layout, context, obj)
    inside = section(layout, "distances", "From Edges")
    if inside is not None:
        draw_distances(inside, obj)
        if not is_simple(context.scene):
            inside.operator("pe.name_edge", icon="EDGESEL")
    if has_view(settings.model):
        layout.operator("pe.look_through", icon="VIEW_CAMERA").name = obj.name
    row = layout.row()
    row.operator_context = "INVOKE_DEFAULT"
    row.operator("pe.place_sensor", text="Drag Along Surface", icon="VIEW_PAN").sensor = obj.name
    draw_region(layout, context, obj)
    draw_mirror(layout, obj, simple=is_simple(context.scene))
    split = layout.split(factor=0.4)
    draw_label(split, "Mounted on")
    mount_name = settings.mount or "Box of Coordinates"
    split.operator_menu_enum("pe.mount_sensor", "mount", text=mount_name, translate=False)
    if not is_simple(context.scene):
        layout.prop(settings, "rack")
    layout.prop(settings, "stays")
    if is_simple(context.scene):
        return
    draw_label(layout, f"The search may change, for {obj.name}:")
    column = layout.column()
    column.active = not settings.stays
    row = column.row(align=True)
    for index, label in enumerate(AXIS_LABELS):
        part = row.row(align=True)
        part.active = index >= len("xyz") or not settings.mount
        part.prop(settings, "free", index=index, text=label, translate=False, toggle=True)
    inside = section(layout, "bounds", "Bounds")
    if inside is not None:
        draw_bounds(inside, settings)
    draw_own_curve(layout, settings)
    inside = section(layout, "data_sheet", "Data Sheet")
    if inside is not None:
        draw_declared(inside, settings, "sensor")


def draw_pose(layout: UILayout, context: Context, obj: Object) -> None:
    """Draw the pose in the ground frame; fixed poses and locked axes are disabled."""
    settings = obj.perception_entropy
    holder = holder_of(obj)
    pair = layout.split()
    for name, texts, locks in (
        ("ground_position", POSITION_LABELS, obj.lock_location),
        ("ground_rotation", AXIS_LABELS[3:], obj.lock_rotation),
    ):
        column = pair.column(align=True)
        for index, text in enumerate(texts):
            cell = column.row(align=True)
            locked = (
                any(locks) if obj.parent else locks[index]
            )  # its own frame is not the ground frame
            cell.enabled = not (holder or locked)
            cell.prop(settings, name, index=index, text=text, translate=False)
    if holder:
        draw_sentence(layout, context, f"Pose is fixed by {holder}", icon="LOCKED")


def draw_distances(layout: UILayout, obj: Object) -> None:
    """Draw from which edges of the vehicle a sensor's position is told, and how far it is."""
    settings = obj.perception_entropy
    known = measured_distances(settings)
    column = layout.column(align=True)
    for index, axis in enumerate(search.POSITION_AXES):
        row = column.split(factor=EDGE_SHARE, align=True)
        row.prop(settings, f"edge_{axis}", text="")
        cell = row.row(align=True)
        if axis in known:
            cell.enabled = not (holder_of(obj) or any(obj.lock_location))
            text = known[axis].way.capitalize()
            cell.prop(settings, "edge_distances", index=index, text=text, translate=False)
        elif getattr(settings, f"edge_{axis}"):
            draw_label(cell, "No such edge", "ERROR")
        else:
            draw_label(cell, POSITION_LABELS[index])


def draw_region(layout: UILayout, context: Context, obj: Object) -> None:
    """Draw the button that finds a sensor's free region; of a known one, how far it may go."""
    row = layout.row(align=True)
    row.operator("pe.free_region", icon="SNAP_FACE").name = obj.name
    layout.prop(context.scene.perception_entropy.view, "show_steepest")
    if (way := shown_way(context)) is not None and way.better is not None:
        text = f"Move {way.better.distance * 100.0:.0f} cm: {way.better.change:+.3f} nats"
        text = worded(context.scene, text)
        layout.operator("pe.take_better_place", text=text, translate=False, icon="FORWARD")
    found = where_map.regions.get(context.scene.name)
    if found is None or found.sensor != obj.name:
        return
    if found.mount is not None:
        row.operator("pe.use_as_mount", text="", icon="MOD_SHRINKWRAP")
    row.operator("pe.dismiss", text="", icon="X").answer = "REGION"
    view = context.scene.perception_entropy.view
    layout.prop(view, "region_loss")
    allowed = found.allowing(view.region_loss) if view.region_loss > 0.0 else found
    for part in allowed.extent.split("; "):
        draw_sentence(layout, context, part)


def draw_mirror(layout: UILayout, obj: Object, *, simple: bool) -> None:
    """Draw the buttons that mirror a sensor, in *Simple* as a linked pair alone; of a linked
    sensor, its partner."""
    row = layout.row(align=True)
    other = obj.perception_entropy.mirror_of
    if other:
        draw_label(row, f"Linked to {other}", "MOD_MIRROR")
        row.operator("pe.unlink_mirror", text="", icon="UNLINKED").name = obj.name
        return
    if not simple:
        row.operator("pe.mirror_sensor", icon="MOD_MIRROR").name = obj.name
    linked = row.operator("pe.mirror_sensor", text="Mirror Linked", icon="LINKED")
    linked.name = obj.name
    linked.linked = True


def draw_bounds(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw the sensor's bounds in a search; by default the vehicle's outline and 0.75 m above."""
    column = layout.column(align=True)
    for index, label in enumerate(AXIS_LABELS):
        if not settings.free[index]:
            continue
        row = column.row(align=True)
        bounded = settings.bounded[index]
        text = label if bounded else f"Bound {label}"
        row.prop(settings, "bounded", index=index, text=text, translate=False, toggle=True)
        if bounded:
            pair = row.row(align=True)
            pair.alert = settings.bounds_low[index] >= settings.bounds_high[index]
            pair.prop(settings, "bounds_low", index=index, text="")
            pair.prop(settings, "bounds_high", index=index, text="")


def draw_own_curve(layout: UILayout, settings: PropertyGroup) -> None:
    """Draw the switch of the sensor's own AP curve, of another perception algorithm."""
    header, inside = layout.panel("PE_own_curve", default_closed=True)
    header.prop(settings, "own_curve")
    if inside is None:
        return
    column = inside.column()
    column.active = settings.own_curve
    draw_label(column, "AP = a ln m - c ln R + b")
    row = column.row(align=True)
    for name in "abc":
        row.prop(settings, f"curve_{name}")


def _part_is_shown(context: Context) -> bool:
    obj = context.active_object
    if obj is None or obj.type == "EMPTY" or in_surroundings(obj):
        return False
    return not obj.perception_entropy.is_sensor


@panel("Vehicle Part", simple=True, closed=False, poll=_part_is_shown)
def part(layout: UILayout, _settings: PropertyGroup, context: Context) -> None:
    """Settings of the part of the vehicle that is selected"""
    obj = context.active_object
    layout.label(text=obj.name, icon="OBJECT_DATA", translate=False)
    layout.prop(obj.perception_entropy, "body")
    layout.prop(obj.perception_entropy, "see_through")
    layout.prop(obj.perception_entropy, "cover_loss_db", text="Radar Cover [dB]")


CLASSES = (sensor, part)
