"""A film of a minute through the window: what the mouse does, and what the panel answers."""

from __future__ import annotations

from .guide import BUDGET, CLOSE, LOOK, OURS, RUNNING, SETTINGS, grab, settled
from .reel import Camera, Reel

WIDTH = 1120
STILL_MS = 3600
MOVING_MS = 160
ROOF = (-0.43, 0.0, 1.8)
BEHIND_SEAT = (0.4, 1.7, 0.0)
AHEAD = LOOK.format(center=(5.0, 0.0, 0.5), distance=24.0, rotation=(1.05, 0.0, 2.3))
BODIES = LOOK.format(center=(4.0, 0.0, 0.5), distance=19.0, rotation=(1.12, 0.0, 2.5))
WHERE = OURS.format("queries.where_map")
PLACES = f"{WHERE}.maps.get(window.scene.name)"
OFFERS = f"{WHERE}.offers.get(window.scene.name)"
SCENARIO = OURS.format("overlay.layer_cache") + ".shown_of(window.scene.name, 'scenario')"
NEAREST = f"""
free = [each for each in {PLACES}.places if each.value is not None]
eye = area.spaces.active.region_3d.view_matrix.inverted().translation
best = min(free, key=lambda each: sum((a - b) ** 2 for a, b in zip(each.point, eye)))
kept["point"] = list(best.point)
"""


def dragged(camera: Camera) -> None:
    """A LiDAR in the hand: the score and blind ground follow."""
    stage = camera.stage
    stage.do(f"{CLOSE}{SETTINGS}settings.live.on, settings.view.show_beams = True, False")
    stage.press("pe.select_object")
    settled(camera)
    camera.caption = "A car with one LiDAR. Within the red outline what is 0.5 m tall stays unseen."
    camera.frame(STILL_MS)
    camera.caption = "Drag it: score, ground map and blind ground follow the mouse."
    x, y = stage.place_of(ROOF)
    stage.point_at(x, y)
    grab(camera)
    for step in [*range(12), *range(12, 4, -1)]:
        stage.mouse("mousemove", round(x - 9 * step), round(y + 5 * step))
        stage.rest(0.4)
        camera.frame(MOVING_MS)
    camera.frame(STILL_MS)
    stage.key("Escape")
    stage.do(f"{SETTINGS}settings.live.on = False")


def surrounded(camera: Camera) -> None:
    """Test bodies round the car: one is moved, and says who sees it."""
    stage = camera.stage
    stage.do(f"bpy.ops.pe.surroundings()\n{BODIES}")
    settled(camera)
    camera.caption = "Test bodies on a road say which sensors see them, and with how much."
    camera.frame(STILL_MS)
    for step in range(10):
        stage.do(f"window.scene.objects['child'].location = (5.4 - 0.45 * {step}, 1.5, 0.0)")
        stage.rest(1.0)
        camera.frame(2 * MOVING_MS)
    camera.frame(STILL_MS // 2)
    stage.do(f"bpy.ops.pe.surroundings()\n{CLOSE}")


def coloured(camera: Camera) -> None:
    """Where?, and a click that places a camera."""
    stage = camera.stage
    camera.caption = "Where should a camera go? The body is coloured by the score with one there."
    stage.do("bpy.ops.pe.where(model='Camera 120 deg')")
    stage.wait_until(f"{PLACES} and {PLACES}.error is not None", 200)
    settled(camera)
    camera.frame(STILL_MS)
    near = tuple(stage.do(NEAREST)["point"])
    camera.caption = "A click puts the sensor there."
    stage.press("pe.take_place")
    stage.click(*stage.place_of(near))
    stage.wait_until("sum(o.perception_entropy.is_sensor for o in window.scene.objects) == 2", 60)
    stage.do(f"{SETTINGS}settings.view.show_where = False")
    settled(camera)
    camera.frame(STILL_MS)


def repaired(camera: Camera) -> None:
    """A click on blind ground, and what would fix it."""
    stage = camera.stage
    camera.caption = "Click blind ground: what hides it, and what would fix it, as ghosts."
    stage.press("pe.ask_place")
    stage.settle()
    stage.click(*stage.place_of(BEHIND_SEAT))
    stage.settle()
    stage.key("Escape")
    stage.press("pe.suggest")
    stage.wait_until(f"{OFFERS} and {OFFERS}.found", 120)
    settled(camera)
    camera.frame(STILL_MS)
    stage.press("pe.take_suggestion")
    camera.caption = "One click takes it."
    settled(camera)
    camera.frame(STILL_MS)


def to_top(camera: Camera) -> None:
    """Show the upper end of the sidebar: score and dashboard."""
    camera.stage.point_at(1480, 600)
    camera.stage.mouse("click", "--repeat", 60, 4)
    camera.stage.rest()


def searched(camera: Camera) -> None:
    """The search at work; its result beside the start."""
    stage = camera.stage
    stage.do(BUDGET.format(240))
    stage.do("bpy.ops.pe.dismiss(answer='QUERY')")
    to_top(camera)
    stage.do("bpy.ops.pe.save_variant()")
    camera.caption = "Optimize: the best placement so far is shown while it searches. Esc keeps it."
    stage.do("bpy.ops.pe.optimize('INVOKE_DEFAULT')")
    for share in (0.1, 0.3, 0.5, 0.7):
        stage.wait_until(
            f"{RUNNING}.current is None or {RUNNING}.current.progress.fraction > {share}", 300
        )
        camera.frame(1200)
    stage.wait_until(f"{RUNNING}.current is None", 600)
    settled(camera)
    to_top(camera)
    camera.caption = "What was found, in figures a designer decides by."
    camera.frame(STILL_MS)
    stage.do(f"""
        {SETTINGS.strip()}
        settings.view.ghost_key, settings.view.wipe = settings.variants[0].key, True
    """)
    settled(camera)
    camera.caption = "Before and after in one view: drag the line."
    for share in (0.3, 0.4, 0.5, 0.6, 0.7, 0.5):
        stage.do(f"{SETTINGS}settings.view.wipe_at = {share}")
        camera.frame(600)
    stage.point_at(620, 330)
    stage.do("bpy.ops.pe.compare_variants('INVOKE_DEFAULT')")
    stage.wait_until(f"{RUNNING}.current is None", 300)
    stage.rest(3.0)
    camera.caption = "Compare: the largest difference first."
    camera.frame(STILL_MS)
    stage.key("Escape")


def driven(camera: Camera) -> None:
    """A scenario that is played: when is the child confirmed, and does the car stop?"""
    stage = camera.stage
    stage.do(f"""
        {SETTINGS.strip()}
        settings.view.ghost_key = 0
        for each in ("frustums", "ground", "blind"):
            setattr(settings.view, "show_" + each, False)
        bpy.ops.pe.add_row(rows="scenarios", kind="crossing_child")
    """)
    stage.do(AHEAD)
    stage.wait_until(SCENARIO, 200)
    settled(camera)
    camera.caption = "A child runs out: when is it confirmed, and does the car stop in time?"
    for frame in range(10, 130, 8):
        stage.do(f"window.scene.frame_set({frame})")
        camera.frame(300)
    camera.frame(STILL_MS)
    camera.film("tour", (0, 32, 1600, 874), WIDTH)


TOUR = Reel("sedan.blend", (dragged, surrounded, coloured, repaired, searched, driven))
