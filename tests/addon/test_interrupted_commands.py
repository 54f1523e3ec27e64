"""``python -m blender_addon`` with signals, full disks and files of a user's own in the way."""

import json
import signal
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

from tests.addon.command_line import FAST, ROOT, command, wait_for
from tests.limits import HANG_S

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals and files")


@pytest.fixture
def blend(car, tmp_path) -> Path:
    path = tmp_path / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.mark.usefixtures("heeded_signals")
def test_being_told_to_end_keeps_the_best(blend, tmp_path):
    out = tmp_path / "out"
    log = tmp_path / "log"
    arguments = (*FAST[:6], "--set", "optimize.candidates=100000", "-o", out)
    with log.open("w") as stderr:
        process = subprocess.Popen(
            command(blend, ["optimize", "--no-review", *arguments]),
            cwd=ROOT,
            stdout=subprocess.DEVNULL,
            stderr=stderr,
        )
        try:
            wait_for("optimizing", log)
            process.send_signal(signal.SIGTERM)
            assert process.wait(HANG_S) == 128 + signal.SIGTERM, log.read_text()
        finally:
            process.kill()
    result = json.loads((out / "result.json").read_text())
    assert result["stopped"] and result["entropy"] <= result["before"]["entropy"]
    assert (out / "optimized.blend").exists()
