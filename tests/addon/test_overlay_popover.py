"""The popover in the 3D view's header offers every layer, and computes nothing."""

from blender_addon.overlay import layers
from blender_addon.panels import overlay_popover
from tests.addon.layouts import drawn


def offered(scene) -> list[str]:
    """Names of the settings that the popover shows."""
    layout = drawn(overlay_popover.view, scene=scene)
    return [name for kind, name in layout.notes if kind == "prop"]


def test_every_layer_has_its_switch(car):
    shown = offered(car)
    for layer in layers.LAYERS:
        assert shown.count(f"show_{layer.name}") == 1, layer.name
    assert "show_legend" in shown


def test_every_setting_of_the_view_is_offered(car):
    """In one state of the popover or another: none can be set by scripts alone."""
    view = car.perception_entropy.view
    view.wipe = True
    shown = set()
    for view.ground_quantity in ("ENTROPY", "COVERAGE"):
        shown |= set(offered(car))
    of_group = {p.identifier for p in view.bl_rna.properties} - {"rna_type", "name"}
    of_group -= {"ghost_key", "ground_fits"}  # by buttons: in the list of variants, Fit Colors
    assert of_group <= shown
