"""Variants as pictures, in a real window: a wipe between two of them, and Compare."""

import pytest

EFFECT_TIMEOUT_S = 60
COMPARED_TIMEOUT_S = 180
SHOWN = (
    "__import__('bl_ext.user_default.perception_entropy.overlay.layer_cache', "
    "fromlist=['shown']).shown.get((bpy.context.window_manager.windows[0].scene.name, 'blind'), {})"
)
ROWS = "bpy.context.window_manager.windows[0].scene.perception_entropy.variants"
VIEW = "bpy.context.window_manager.windows[0].scene.perception_entropy.view"


@pytest.mark.thorough
def test_two_variants_in_one_view_and_side_by_side(window, screenshots):
    window.press_until("pe.save_variant", lambda: window.state["variants"], "a variant")
    window.press("pe.select_object")
    window.point_at_view()
    start = window.state["places"]
    window.key("g", "x", "1", "Return")
    window.wait_for(lambda: window.state["places"] != start, EFFECT_TIMEOUT_S, "the move")
    window.do(f"bpy.ops.pe.save_variant(); {VIEW}.show_reach = True")
    window.press("pe.ghost_variant")
    window.do(f"{VIEW}.wipe = True")
    window.wait_until(f"len({SHOWN}) == 2", EFFECT_TIMEOUT_S)
    window.screenshot(screenshots / "window_wipe.png")
    window.press("pe.compare_variants")
    window.wait_until(f"all(row.figures_json for row in {ROWS})", COMPARED_TIMEOUT_S)
    window.settle()
    window.screenshot(screenshots / "window_compare.png", aside=False)
    window.key("Escape")
    assert "Traceback" not in window.log.read_text()
