"""The architecture's table of what goes where holds: one of its rows is followed in a copy."""

import re
import shutil
import subprocess
import sys

import pytest

from tests.engine.test_docs import ROOT

PAGE = (ROOT / "ARCHITECTURE.md").read_text("utf-8")
CHECK = """
    if sensor.pose.position[2] > 1.5:
        yield Advice(sensor.name, "far_up", {"height": sensor.pose.position[2]})
"""
TEXT = """
    "far_up": lambda _, height: f"a ladder is needed: {height:.2f} m",
"""
STUDY = """\
samples = 1024
[[sensor]]
name = "roof"
model = "Velodyne VLP-16 Puck"
position = [0.0, 0.0, 1.8]
"""


@pytest.fixture
def copy(tmp_path):
    for package in ("pe_core", "pe_tools"):
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / package, tmp_path / package, ignore=ignored)
    (tmp_path / "car.toml").write_text(STUDY)
    return tmp_path


def add(path, after, text):
    source = path.read_text("utf-8")
    assert source.count(after) == 1
    path.write_text(source.replace(after, after + text), "utf-8")


def test_a_warning_is_a_check_and_a_text_in_two_files(copy):
    """The row names both files; `pe explain` and the warnings of Python then have it."""
    (row,) = re.findall(r"^\| a warning \| (.*) \|$", PAGE, re.MULTILINE)
    assert "`advice/mount_checks`" in row and "`wording.WARNINGS`" in row
    add(copy / "pe_tools/advice/mount_checks.py", "    x, y, z = sensor.pose.position\n", CHECK)
    add(copy / "pe_tools/wording.py", "WARNINGS: Mapping[str, Callable[..., str]] = {", TEXT)
    run = subprocess.run(
        [sys.executable, "-m", "pe_tools", "explain", "car.toml"],
        cwd=copy,
        capture_output=True,
        text=True,
        env={"PATH": "", "PYTHONPATH": str(copy)},
    )
    assert run.returncode == 0, run.stderr
    assert "a ladder is needed: 1.80 m" in run.stdout
