"""`make test` when a test ends its process: that test fails, all others run."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TESTS = """
import os, signal

def test_before():
    pass

def test_that_crashes():
    if {crashes}:
        os.kill(os.getpid(), signal.SIGKILL)
"""


def test_one_test_fails_and_the_others_run(tmp_path):
    for number in range(3):
        tests = TESTS.format(crashes=number == 1)
        (tmp_path / f"test_{number}.py").write_text(tests, encoding="utf-8")
    (tmp_path / "test_single.py").write_text("def test_alone(): pass\n", encoding="utf-8")
    options = ("-p", "tests.conftest", "-c", os.devnull, "--rootdir", str(tmp_path), "-q")
    shared = ("--numprocesses", "1", "--dist", "loadscope", "--no-loadscope-reorder")
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", *options, *shared, str(tmp_path)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert "1 failed, 6 passed" in ran.stdout.splitlines()[-1], ran.stdout + ran.stderr
