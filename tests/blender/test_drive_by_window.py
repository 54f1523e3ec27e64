"""A drive-by in a real window: it is played from a cache, and says when it is out of date."""

import pytest

from tests.blender.test_live import NAME

EFFECT_TIMEOUT_S = 120
SHOW = """
settings = window.scene.perception_entropy
bpy.ops.pe.add_sensor(model="Pandar64")
bpy.context.object.name, bpy.context.object.location = "corner", (2.2, 0.8, 0.7)
for each in ("beams", "frustums", "ground", "blind", "reach"):
    setattr(settings.view, "show_" + each, False)
bpy.ops.pe.add_row(rows="scenarios", kind="crossing_child")
look = area.spaces.active.region_3d
look.view_location, look.view_distance = (6.0, 0.0, 0.5), 24.0
"""
SHAPE = f"""
from {NAME}.overlay.layer_cache import shown_of
from {NAME}.overlay import draw_handler, scheduler
items = shown_of(window.scene.name, "scenario")
kept["frames"] = [len(item.shape.frames) for item in items.values()]
kept["made"] = [id(item) for item in items.values()]
kept["old"] = [scheduler.is_preview(window.scene.name, "scenario", n, i) for n, i in items.items()]
"""
PLAY = """
drawn = kept["drawn"] = []
def noted():
    drawn.append(window.scene.frame_current)
view = bpy.types.SpaceView3D
bpy.app.driver_namespace["noted"] = view.draw_handler_add(noted, (), "WINDOW", "POST_VIEW")
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.pe.play_scenario()
"""
STOP = """
with bpy.context.temp_override(window=window, area=area, region=region):
    bpy.ops.screen.animation_cancel()
bpy.types.SpaceView3D.draw_handler_remove(bpy.app.driver_namespace.pop("noted"), "WINDOW")
"""
FILM = f"""
from pathlib import Path
from {NAME} import document
from {NAME}.view import film
window.scene.render.fps = 4
with bpy.context.temp_override(window=window, area=area, region=region):
    study = document.study_as_drawn(window.scene)
    scenario = document.scenario_of(window.scene.perception_entropy.scenarios[0])
    film.FilmRender(window.scene, study, scenario, Path({{path!r}}))
kept["shown"] = window.screen.areas[0].type
"""
RENDERING = "bpy.app.is_job_running('RENDER')"


def test_a_film_is_rendered_beside_the_window_and_esc_keeps_what_is_done(stage, tmp_path):
    stage.do(SHOW)
    path = tmp_path / "film.webm"
    assert stage.do(FILM.format(path=str(path)))["shown"] == "VIEW_3D"
    stage.wait_until("'Append frame 1' in open(" + repr(str(stage.log)) + ").read()")
    assert stage.do(f"kept['on'] = {RENDERING}")["on"], "the window answers while it renders"
    stage.point_at_view()
    stage.key("Escape")
    stage.wait_until(f"not {RENDERING}")
    stage.wait_for(path.exists, EFFECT_TIMEOUT_S, "the film")
    assert path.stat().st_size > 1000 and "Traceback" not in stage.log.read_text()


@pytest.mark.thorough
def test_a_scenario_is_played_from_its_cache(stage, screenshots):
    stage.do(SHOW)
    stage.wait_for(
        lambda: stage.do(SHAPE, redraw=False)["frames"] == [145], EFFECT_TIMEOUT_S, "the cache"
    )
    for frame in (20, 90, 122):
        stage.do(f"window.scene.frame_set({frame})")
        stage.screenshot(screenshots / f"window_drive_by_{frame}.png")
    made = stage.do(SHAPE)["made"]
    stage.do(PLAY)
    stage.wait_for(
        lambda: len(set(stage.do("pass")["drawn"])) > 20, EFFECT_TIMEOUT_S, "frames that are drawn"
    )
    stage.do(STOP)
    assert stage.do(SHAPE)["made"] == made, "made again while it is played"
    stage.do('bpy.data.objects["corner"].location.z = 1.0')
    stage.wait_for(
        lambda: stage.do(SHAPE, redraw=False)["old"] == [False], EFFECT_TIMEOUT_S, "a new cache"
    )
    assert "Traceback" not in stage.log.read_text()
