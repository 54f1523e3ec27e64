"""What a real Blender exports by its defaults scores as the scene, whichever version it is."""

import re
import subprocess
import sys

import pytest

from tests.blender.conftest import ROOT
from tests.blender.runner import output_of
from tests.limits import HANG_S

FORMATS = {"glb", "obj", "ply", "stl"}
"""Those that every Blender has."""


@pytest.mark.thorough
def test_exports_have_the_scene_s_entropy_to_six_digits(blender):
    command = [sys.executable, ROOT / "tools" / "exports" / "compare.py", blender.command]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=HANG_S)
    assert answer.returncode == 0, output_of(answer)
    scored = re.findall(r"^  \S.*? (\w+) +(-?\d+\.\d{9})", answer.stdout, re.MULTILINE)
    assert set(FORMATS) <= {ending for ending, _ in scored}, output_of(answer)
    assert len(scored) >= 2 * len(FORMATS), "the sedan and the bus"
