"""Pictures of the documentation are of the panel that there is."""

from blender_addon.panels import main
from tests.addon import panel_digest


def test_the_pictures_are_not_older_than_the_panel(addon):
    found = panel_digest.digest(panel_digest.scene_of_digest())
    is_same = panel_digest.KEPT.read_text().strip() == found
    assert is_same, "the panel has changed: make screenshots, and look at what they show"


def test_another_panel_has_another_digest(addon, monkeypatch):
    scene = panel_digest.scene_of_digest()
    before = panel_digest.digest(scene)
    monkeypatch.setattr(main.main, "bl_label", "Another")
    assert panel_digest.digest(scene) != before
