"""A search on a painted roof in a real window: the mount, the best placement so far, Esc, undo."""

START_TIMEOUT_S, BETTER_TIMEOUT_S = 60, 120
ADDON = "bl_ext.user_default.perception_entropy"
ON_THE_ROOF_M = 1.45 + 0.04 + 0.12
"""No sensor on a base plate of 40 mm is higher than this."""


def test_a_search_on_a_painted_roof_shows_the_best_so_far(stage, screenshots):
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
    start = place(stage)
    assert start[2] < ON_THE_ROOF_M
    stage.press_until("pe.optimize", lambda: stage.state["running"], "the search to start")
    stage.wait_until(f"bool({VIEW})", BETTER_TIMEOUT_S)
    stage.point_at_view()
    stage.rest()  # the search goes on drawing
    stage.photograph(screenshots / "window_search.png")

    stage.key("Escape")
    found = "getattr(window.scene.perception_entropy.result, 'kind', '')"
    stage.wait_until(f"{found} == 'optimize'", BETTER_TIMEOUT_S)
    stage.wait_until(f"not {VIEW}")
    found = place(stage)
    assert found != start and found[2] < ON_THE_ROOF_M
    stage.point_at_view()
    stage.key("ctrl+z")
    stage.wait_until(f"abs({PLACE}.x - {start[0]}) < 1e-6", START_TIMEOUT_S)
    check_an_export(stage, screenshots)
    assert "Traceback" not in stage.log.read_text()


def check_an_export(stage, screenshots):
    """A page asked for in a file dialog: Esc leaves nothing, without it there is the page."""
    page = stage.folder / "review.html"
    ask_for(stage, page)
    stage.wait_until(
        f"{RUNNING} is not None and {RUNNING}.progress.fraction > 0.0", START_TIMEOUT_S
    )
    stage.key("Escape")
    stage.wait_until(f"{RUNNING} is None", START_TIMEOUT_S)
    assert not page.exists(), "half a page"

    ask_for(stage, page)
    stage.wait_until(
        f"{RUNNING} is not None and {RUNNING}.progress.stage == 'page'", START_TIMEOUT_S
    )
    stage.photograph(screenshots / "window_exporting.png")
    stage.wait_for(page.exists, BETTER_TIMEOUT_S, "the page")
    stage.wait_until(f"{RUNNING} is None", BETTER_TIMEOUT_S)
    stage.photograph(screenshots / "window_exported.png")
    assert "</html>" in page.read_text("utf-8")[-20:]


def ask_for(stage, page):
    """Have a file dialog ask for the page, and agree."""
    stage.do(f"""
        bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.pe.export_review("INVOKE_DEFAULT", filepath={str(page)!r})
    """)
    stage.wait_until("any(area.type == 'FILE_BROWSER' for area in window.screen.areas)")
    stage.settle()
    stage.key("Return")


VIEW = f"__import__('{ADDON}.best_so_far', fromlist=['searches']).searches"
RUNNING = f"__import__('{ADDON}.operators.running_job', fromlist=['current']).current"
PLACE = "bpy.data.objects['roof_lidar'].matrix_world.translation"


def place(stage) -> list[float]:
    return stage.do(f"kept['place'] = list({PLACE})")["place"]
