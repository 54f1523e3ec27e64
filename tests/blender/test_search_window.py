"""From a new sensor to a result, by clicks: score, a search on a painted roof, Esc, undo."""

import math

START_TIMEOUT_S = 60
BETTER_TIMEOUT_S = 180
ADDON = "bl_ext.user_default.perception_entropy"
ON_THE_ROOF_M = 1.45 + 0.04 + 0.12
"""No sensor on a base plate of 40 mm is higher than this."""
VIEW = f"__import__('{ADDON}.view.best_so_far', fromlist=['searches']).searches"
RUNNING = f"__import__('{ADDON}.operators.running_job', fromlist=['current']).current"
PLACE = "bpy.data.objects['roof_lidar'].matrix_world.translation"


def test_a_search_beside_the_window_esc_keeps_the_best_and_undo_brings_back(stage, screenshots):
    stage.do("""
        settings, roof = window.scene.perception_entropy, bpy.data.objects["roof"]
        settings.score_samples = settings.search_samples = 1024
        settings.method, settings.candidates = "random", 40
        settings.view.show_ground = False
        group = roof.vertex_groups.new(name="painted")
        group.add([v.index for v in roof.data.vertices if abs(v.co.y) < 0.5], 1.0, "REPLACE")
        row = settings.mounts.add()
        row.name, row.faces, row.group, row.standoff = "roof", "GROUP", "painted", 0.04
        with bpy.context.temp_override(window=window, area=area):
            bpy.ops.pe.mount_sensor(name="roof_lidar", mount="roof")
            bpy.ops.ed.undo_push(message="on the roof")
    """)
    before = len(stage.state["sensors"])
    stage.press_until(
        "pe.add_sensor", lambda: len(stage.state["sensors"]) == before + 1, "a new sensor"
    )
    assert not stage.state["has_result"], "a result that nobody asked for"
    stage.press_until("pe.score", lambda: stage.state["has_result"], "a score")
    stage.screenshot(screenshots / "window_score.png")
    assert math.isfinite(stage.state["entropy"])
    assert 0.0 <= stage.state["coverage"] <= 1.0

    start = stage.state["places"]
    assert place(stage)[2] < ON_THE_ROOF_M
    stage.press_until("pe.optimize", lambda: stage.state["running"], "the search to start")
    stage.wait_for(lambda: stage.state["better_found"], BETTER_TIMEOUT_S, "a better placement")
    stage.wait_until(f"bool({VIEW})", BETTER_TIMEOUT_S)
    stage.point_at_view()
    stage.rest()  # the search goes on drawing
    stage.photograph(screenshots / "window_search.png")
    assert stage.state["running"], "the search was over before anyone could press Esc"

    stage.key("ctrl+z")
    assert stage.state["running"] and stage.state["places"] == start
    stage.key("Escape")
    stage.wait_for(lambda: stage.state["kind"] == "optimize", BETTER_TIMEOUT_S, "a result")
    stage.wait_until(f"not {VIEW}")
    assert stage.state["places"] != start, "the best so far was not kept"
    assert place(stage)[2] < ON_THE_ROOF_M
    stage.point_at_view()
    stage.key("ctrl+z")
    stage.wait_for(lambda: stage.state["places"] == start, START_TIMEOUT_S, "the old placement")
    assert len(stage.state["variants"]) == 2, "undo has lost what the search found"
    check_an_export(stage)
    assert "Traceback" not in stage.log.read_text()


def check_an_export(stage):
    """A page asked for in a file dialog: Esc leaves nothing."""
    page = stage.folder / "review.html"
    ask_for(stage, page)
    stage.wait_until(
        f"{RUNNING} is not None and {RUNNING}.progress.fraction > 0.0", START_TIMEOUT_S
    )
    stage.key("Escape")
    stage.wait_until(f"{RUNNING} is None", START_TIMEOUT_S)
    assert not page.exists(), "half a page"


def ask_for(stage, page):
    """Have a file dialog ask for the page, and agree."""
    stage.do(f"""
        bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.pe.export_file("INVOKE_DEFAULT", filepath={str(page)!r})
    """)
    stage.wait_until("any(area.type == 'FILE_BROWSER' for area in window.screen.areas)")
    stage.settle()
    stage.key("Return")


def place(stage) -> list[float]:
    return stage.do(f"kept['place'] = list({PLACE})")["place"]
