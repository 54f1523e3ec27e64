"""States, weathers and stories in the panel: add, remove; show a state, read its motions again."""

import bpy
from bpy.props import EnumProperty, IntProperty

from .. import bridge, film, signals
from ..engine import motion, pe
from .declared import RowList, chosen_file, operator
from .exports import dialog

DRAWN = -1
WEATHERS = (
    ("CLEAR", "Clear Air", "Sensors as they are"),
    ("RAIN", "Rain", "25 mm/h: heavy rain"),
    ("SNOW", "Snow", "2.5 mm/h of water"),
    ("FOG", "Fog", "A visibility of 100 m"),
    ("NIGHT", "Night", "Cameras see what headlamps light"),
)
STARTS = {"RAIN": ("rain_mm_h", 25.0), "SNOW": ("snow_mm_h", 2.5), "FOG": ("fog_mor_m", 100.0)}
STATE_ROWS = RowList("states", "state_index", "state")
WEATHER_ROWS = RowList("weathers", "weather_index", "weather")
STATE_ROWS.operators(remove="Remove the selected state")
WEATHER_ROWS.operators(remove="Remove the selected weather")
STORY_ROWS = RowList("stories", "story_index", "story")
STORY_ROWS.operators(remove="Remove the selected story")


@operator("Add State of This Frame", signal=signals.study_changed)
def add_state(context: bpy.types.Context) -> str:
    """Add the frame that is shown as a state of the vehicle; what has moved is read here"""
    scene, settings = context.scene, context.scene.perception_entropy
    before, frame = settings.state_index, scene.frame_current
    is_drawn = frame == settings.drawn_frame
    row = STATE_ROWS.add(scene, "As Drawn" if is_drawn else f"Frame {frame}")
    name, row.frame = row.name, frame
    try:
        bridge.read_states(scene)
    except pe.InputError:
        settings.states.remove(len(settings.states) - 1)
        settings.state_index = before
        raise
    return f"Added state {name}"


@operator("Read States Again")
def read_states(context: bpy.types.Context) -> str:
    """Read what moves in all states again: the animation has changed"""
    changed = bridge.read_states(context.scene)
    return f"States changed: {', '.join(changed)}" if changed else "No state has changed"


@operator(
    "Show State",
    signal=signals.study_changed,
    index=IntProperty(name="State", description="Row of the list; -1: as drawn", default=DRAWN),
)
def show_state(context: bpy.types.Context, index: int) -> None:
    """Show this state in the 3D view; live score and maps are those of what is shown"""
    settings = context.scene.perception_entropy
    rows = settings.states
    frame = rows[index].frame if 0 <= index < len(rows) else settings.drawn_frame
    if frame < 0:
        raise pe.InputError("scene", "state", "a state with a frame of the scene", "none")
    context.scene.frame_set(frame)


@operator(
    "Add Weather",
    signal=signals.study_changed,
    weather=EnumProperty(items=WEATHERS, name="Weather", description="What it starts with"),
)
def add_weather(context: bpy.types.Context, weather: str) -> None:
    """Add a weather in which the rig is scored"""
    label = next(label for key, label, _ in WEATHERS if key == weather)
    row = WEATHER_ROWS.add(context.scene, label)
    row.night = weather == "NIGHT"
    if weather in STARTS:
        setattr(row, *STARTS[weather])


STORY_ITEMS = [(name, each.title, each.source) for name, each in motion.stories().items()]


@operator(
    "Add Story",
    signal=signals.study_changed,
    story=EnumProperty(items=STORY_ITEMS, name="Story", description="What moves"),
)
def add_story(context: bpy.types.Context, story: str) -> None:
    """Add a story of what moves: when is it confirmed, and does the vehicle stop in time?"""
    row = STORY_ROWS.add(context.scene, story)
    name = row.name
    bridge.write_story(row, motion.stories()[story])
    row.name = name


@operator("Play", signal=signals.study_changed, unless=STORY_ROWS.unless_selected)
def play_story(context: bpy.types.Context) -> None:
    """Play the selected story from its first frame. Again: stop"""
    scene, settings = context.scene, context.scene.perception_entropy
    row = settings.stories[settings.story_index]
    playing = context.screen is not None and context.screen.is_animation_playing
    if not playing:
        story = bridge.story_of(row)
        frames = round(-story.start_s * bridge.frame_rate(scene))
        scene.frame_end = scene.frame_start + frames
        scene.frame_set(scene.frame_start)
        settings.view.show_story = settings.show_overlay = True
    if not bpy.app.background:
        bpy.ops.screen.animation_play()


@operator(
    "Film", unless=STORY_ROWS.unless_selected, **dialog("", lambda _self: f"drive_by{film.WEBM}")
)
def film_story(context: bpy.types.Context, filepath: str) -> str:
    """Render the selected story as a film (.webm, .mp4), with what the 3D view shows over it"""
    settings, path = context.scene.perception_entropy, chosen_file(filepath)
    story = bridge.story_of(settings.stories[settings.story_index])
    film.write_film(context.scene, bridge.study_as_drawn(context.scene), story, path)
    return f"Wrote {path}"
