"""The steps of docs/guide.md, in one go, as its reader does them."""

from __future__ import annotations

from .reel import Camera, Reel

VEHICLE = "My car"
ROOF = (-0.45, 0.0, 1.45)
BONNET_AHEAD = (9.0, 3.0, 0.0)
LOOK = """
from mathutils import Euler
look = area.spaces.active.region_3d
look.view_location, look.view_distance = {center}, {distance}
look.view_rotation = Euler({rotation}).to_quaternion()
"""
CLOSE = LOOK.format(center=(0.1, -0.5, 0.7), distance=7.6, rotation=(1.12, 0.0, 2.23))
WIDE = LOOK.format(center=(2.0, -2.0, 0.0), distance=34.0, rotation=(0.95, 0.0, 2.4))
SIDEBAR = (1240, 32, 1600, 874)
DASHBOARD = (1276, 84, 1600, 560)
HAS_RESULT = "window.scene.perception_entropy.has_result"
OURS = "__import__('bl_ext.user_default.perception_entropy.{}', fromlist=['*'])"
RUNNING = OURS.format("operators.running_job")
LIVE_READING = OURS.format("live.state") + ".live_state(window.scene.name).score"
MODAL = "[each.bl_idname.lower().replace('_ot_', '.') for each in window.modal_operators]"
IDLE = f"not {OURS.format('processes.engine_process')}.busy('live score')"
PLACING = OURS.format("operators.placement")
SENSORS = "any(each.perception_entropy.is_sensor for each in window.scene.objects)"
ANSWER = OURS.format("queries.location_query") + ".answer(window.scene)"
SETTINGS = "settings = window.scene.perception_entropy\n"
BUDGET = f"""
{SETTINGS.strip()}
settings.evaluations, settings.search_samples = {{}}, 4096
for each in window.scene.objects:
    if each.perception_entropy.model.startswith("Camera"):  # its place is the body's
        each.perception_entropy.free = (False, False, False, False, True, True)
"""


def imported(camera: Camera) -> None:
    """A mesh somebody else has made."""
    path = str(camera.scratch / "sedan.obj")
    camera.stage.do(
        f"bpy.ops.wm.obj_import(filepath={path!r}, forward_axis='Y', up_axis='Z')\n{CLOSE}"
    )
    camera.stage.rest()
    camera.still("guide_import")


def chosen(camera: Camera) -> None:
    """Its collection is the vehicle, its windows are glass."""
    camera.stage.do(f"""
        bpy.data.collections[0].name = {VEHICLE!r}
        window.scene.perception_entropy.vehicle = bpy.data.collections[0]
        for each in window.scene.objects:
            glass = each.name.startswith("wind") or each.name.startswith("rear_window")
            each.perception_entropy.see_through = glass
            each.select_set(False)
        shown = window.scene.objects["windshield"]
        shown.select_set(True)
        window.view_layer.objects.active = shown
    """)
    camera.stage.rest()
    camera.still("guide_vehicle", SIDEBAR)


def pointed(camera: Camera) -> None:
    """A LiDAR under the mouse, on the roof, with its preview of a score."""
    stage = camera.stage
    stage.do("bpy.ops.object.select_all(action='DESELECT')")
    x, y = stage.place_of(ROOF)
    stage.point_at(x - 60, y + 60)
    stage.do("bpy.ops.pe.place_sensor('INVOKE_DEFAULT', model='Pandar64')")
    for step in range(8):
        stage.point_at(x - 56 + 8 * step, y + 56 - 8 * step)
    stage.wait_until(f"{PLACING}.current.score", 60)
    camera.still("guide_pointing")
    stage.click(x, y)
    stage.wait_until(SENSORS)


def cameras(camera: Camera) -> None:
    """Two cameras: one behind the windscreen, one in the bumper."""
    camera.stage.do("""
        for x, z, model in ((0.35, 1.25, "Camera 60 deg"), (2.33, 0.65, "Camera 120 deg")):
            bpy.ops.pe.add_sensor(model=model)
            bpy.context.object.location = (x, 0.0, z)
        bpy.context.object.name = "Camera in the bumper"
    """)
    camera.stage.rest()


def lively(camera: Camera) -> None:
    """The LiDAR in the hand: what a drag changes."""
    stage = camera.stage
    stage.do(f"""
        {SETTINGS.strip()}
        settings.live.on, settings.view.show_beams = True, False
        lidar = next(o for o in window.scene.objects
                     if o.perception_entropy.is_sensor and o.perception_entropy.model == "Pandar64")
        bpy.ops.object.select_all(action="DESELECT")
        lidar.select_set(True)
        window.view_layer.objects.active = lidar
    """)
    stage.wait_until(LIVE_READING)
    settled(camera)
    x, y = stage.place_of(ROOF)
    stage.point_at(x, y)
    grab(camera)
    for step in range(10):
        stage.point_at(x - 4 * step, y + 3 * step)
    stage.wait_until(f"{LIVE_READING}.before")
    stage.rest()
    camera.still("guide_live")
    stage.key("Escape")
    stage.rest()


def mapped(camera: Camera) -> None:
    """The ground map, the blind ground and reach, and where they are switched."""
    stage = camera.stage
    stage.do(f"""
        {SETTINGS.strip()}
        settings.view.show_beams = False
        settings.view.show_ground = settings.view.show_blind = settings.view.show_reach = True
    """)
    stage.do(WIDE)
    stage.point_at(400, 500)  # off the gizmo, which would tell what it is
    settled(camera)
    camera.still("guide_map")
    stage.point_at(1050, 60)
    stage.do("bpy.ops.wm.call_panel('INVOKE_DEFAULT', name='PE_PT_view', keep_open=True)")
    stage.rest()
    camera.still("guide_popover", (740, 32, 1240, 560))
    stage.key("Escape")
    stage.point_at(400, 500)
    stage.do(f"{SETTINGS}settings.view.show_ground = settings.view.show_reach = False")
    stage.do(CLOSE)


def grab(camera: Camera) -> None:
    """Take what is selected in the hand, along x."""
    camera.stage.key("g")
    camera.stage.wait_until(f"'transform.translate' in {MODAL}")
    camera.stage.key("x")


def settled(camera: Camera) -> None:
    """Wait until all that is worked out beside the window is drawn."""
    for _ in range(2):  # what comes may ask for more
        camera.stage.rest(3.0)
        camera.stage.wait_until(IDLE, 300)


def scored(camera: Camera) -> None:
    """A score, in figures and in words; no sensor is selected, so that the words are in sight."""
    stage = camera.stage
    stage.do("""
        bpy.ops.object.select_all(action="DESELECT")
        window.view_layer.objects.active = None
    """)
    stage.do("bpy.ops.pe.score('INVOKE_DEFAULT')")
    stage.wait_until(HAS_RESULT, 180)
    stage.rest()
    camera.still("guide_score")
    stage.do(f"{SETTINGS}settings.limit_blind_ground, settings.limit_ap_far = 12.0, 0.4")
    stage.rest()
    camera.still("dashboard", DASHBOARD)
    for name in ("blind_ground", "ap_far"):
        stage.do(f"{SETTINGS}settings.limit_{name} = -100")


def asked(camera: Camera) -> None:
    """Who sees a place on the ground, and who does not."""
    stage = camera.stage
    stage.do(f"bpy.ops.pe.ask_place(point={BONNET_AHEAD})\n{WIDE}")
    stage.wait_until(ANSWER)
    stage.rest()
    camera.still("guide_ask")
    stage.do(f"bpy.ops.pe.dismiss(answer='QUERY')\n{CLOSE}")


def optimized(camera: Camera) -> None:
    """The search at work, then what it has found, as two variants side by side."""
    stage = camera.stage
    stage.do(BUDGET.format(90))
    stage.do("bpy.ops.pe.save_variant()")
    stage.do("bpy.ops.pe.optimize('INVOKE_DEFAULT')")
    stage.wait_until(f"{RUNNING}.current and {RUNNING}.current.progress.fraction > 0.4", 300)
    camera.still("guide_optimize")
    stage.wait_until(f"{RUNNING}.current is None", 600)
    settled(camera)  # the sensors are moved by an update after the job
    camera.still("guide_optimized")
    stage.point_at(800, 105)
    stage.do("bpy.ops.pe.compare_variants('INVOKE_DEFAULT')")
    stage.wait_until(f"{RUNNING}.current is None", 300)
    stage.rest(3.0)
    camera.still("guide_compare")
    stage.key("Escape")


def reported(camera: Camera) -> None:
    """The review picture."""
    path = camera.scratch / "review.svg"
    camera.stage.do(f"bpy.ops.pe.export_file(filepath={str(path)!r})")
    camera.stage.wait_until(
        f"{RUNNING}.current is None and __import__('os').path.exists({str(path)!r})", 120
    )
    camera.keep("guide_report", path)


GUIDE = Reel(
    "empty.blend",
    (imported, chosen, pointed, cameras, lively, mapped, scored, asked, optimized, reported),
)
