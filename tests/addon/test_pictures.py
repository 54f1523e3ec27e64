"""Pictures of the documentation are of the panel that there is."""

import subprocess
import sys
from pathlib import Path

import pytest

from blender_addon.panels import main
from tests.addon import panel_digest
from tests.limits import HANG_S

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.usefixtures("addon")
def test_the_pictures_are_not_older_than_the_panel():
    """In a process of its own: what other tests leave behind may be drawn, too."""
    command = [sys.executable, "-m", "tests.addon.panel_digest", "--print"]
    said = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=HANG_S)
    found = said.stdout.strip().splitlines()[-1]
    is_same = panel_digest.KEPT.read_text().strip() == found
    assert is_same, "the panel has changed: make screenshots, and look at what they show"


def test_another_panel_has_another_digest(addon, monkeypatch):
    scene = panel_digest.scene_of_digest()
    before = panel_digest.digest(scene)
    monkeypatch.setattr(main.main, "bl_label", "Another")
    assert panel_digest.digest(scene) != before
