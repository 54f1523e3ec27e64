"""States, weathers and scenarios in the panel: add, remove; show a state, read it again."""

import bpy
from bpy.props import IntProperty

from .. import document, signals
from ..engine import motion, pe
from .declared import operator
from .rows import new_row, row_list, unless_selected

DRAWN = -1
WEATHERS = (
    ("CLEAR", "Clear Air", "Sensors as they are"),
    ("RAIN", "Rain", "25 mm/h: heavy rain"),
    ("SNOW", "Snow", "2.5 mm/h of water"),
    ("FOG", "Fog", "A visibility of 100 m"),
    ("NIGHT", "Night", "Cameras see what headlamps light"),
)
STARTS = {"RAIN": ("rain_mm_h", 25.0), "SNOW": ("snow_mm_h", 2.5), "FOG": ("fog_mor_m", 100.0)}
SCENARIO_ITEMS = [(name, each.title, each.source) for name, each in motion.scenarios().items()]


def add_state(context: bpy.types.Context, _kind: str) -> str:
    """Add the frame that is shown as a state of the vehicle; what has moved is read here"""
    scene = context.scene
    settings = context.scene.perception_entropy
    before = settings.state_index
    frame = scene.frame_current
    is_drawn = frame == settings.drawn_frame
    row = new_row(scene, "states", "As Drawn" if is_drawn else f"Frame {frame}")
    name = row.name
    row.frame = frame
    try:
        document.read_states(scene)
    except pe.InputError:
        settings.states.remove(len(settings.states) - 1)
        settings.state_index = before
        raise
    return f"Added state {name}"


@operator("Read States Again")
def read_states(context: bpy.types.Context) -> str:
    """Read what moves in all states again: the animation has changed"""
    changed = document.read_states(context.scene)
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


def add_weather(context: bpy.types.Context, weather: str) -> None:
    """Add a weather in which the rig is scored"""
    label = next(label for key, label, _ in WEATHERS if key == weather)
    row = new_row(context.scene, "weathers", label)
    row.night = weather == "NIGHT"
    if weather in STARTS:
        setattr(row, *STARTS[weather])


def add_scenario(context: bpy.types.Context, scenario: str) -> None:
    """Add a scenario of what moves: when is it confirmed, and does the vehicle stop in time?"""
    row = new_row(context.scene, "scenarios", scenario)
    name = row.name
    document.write_scenario(row, motion.scenarios()[scenario])
    row.name = name


row_list("states", "state", add=add_state)
row_list("weathers", "weather", add=add_weather, kinds=WEATHERS)
row_list("scenarios", "scenario", add=add_scenario, kinds=SCENARIO_ITEMS)


@operator("Play", signal=signals.study_changed, unless=unless_selected("scenarios"))
def play_scenario(context: bpy.types.Context) -> None:
    """Play the selected scenario from its first frame. Again: stop"""
    scene = context.scene
    settings = context.scene.perception_entropy
    row = settings.scenarios[settings.scenario_index]
    playing = context.screen is not None and context.screen.is_animation_playing
    if not playing:
        scenario = document.scenario_of(row)
        frames = round(-scenario.start_s * document.frame_rate(scene))
        scene.frame_end = scene.frame_start + frames
        scene.frame_set(scene.frame_start)
        settings.view.show_scenario = settings.show_overlay = True
    if not bpy.app.background:
        bpy.ops.screen.animation_play()
