"""`make test` when a test crashes, computes for ever, or fails while what it started runs on."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import psutil
import pytest

from tests.limits import HANG_S

ROOT = Path(__file__).resolve().parents[2]
CRASHES = """
import os, signal

def test_before():
    pass

def test_that_crashes():
    if {crashes}:
        os.kill(os.getpid(), signal.SIGKILL)
"""
COMPUTES = """
from tests import limits
limits.PROCESSOR_LIMIT_S = 0.2

def test_that_computes_for_ever():
    while True:
        pass
"""
LEAVES = """
import pathlib, signal, subprocess, sys
import pytest

SLEEP = [sys.executable, "-c", "import time; print(flush=True); time.sleep(1000)"]
ORPHAN = (
    f"import subprocess; print(subprocess.Popen({SLEEP}, stdout=subprocess.DEVNULL, "
    "stderr=subprocess.DEVNULL, start_new_session=True).pid)"
)

@pytest.mark.usefixtures("heeded_signals")
def test_signals():
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert signal.getsignal(signal.SIGHUP) is signal.SIG_DFL

def test_that_leaves_processes():
    assert signal.getsignal(signal.SIGINT) is signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    child = subprocess.Popen(SLEEP, stdout=subprocess.PIPE)
    child.stdout.readline()
    orphan = subprocess.run([sys.executable, "-c", ORPHAN], capture_output=True, text=True).stdout
    pathlib.Path("left").write_text(f"{child.pid} {orphan}")
    raise AssertionError
"""


def run(folder, *options, **more):
    """Run pytest on the tests of a folder, by the rules of ours."""
    ours = ("-p", "tests.conftest", "-c", os.devnull, "--rootdir", str(folder), "-q")
    return subprocess.run(
        [sys.executable, "-m", "pytest", *ours, *options, str(folder)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=HANG_S,
        **more,
    ).stdout


def test_one_that_crashes_fails_and_the_others_run(tmp_path):
    for number in range(3):
        tests = CRASHES.format(crashes=number == 1)
        (tmp_path / f"test_{number}.py").write_text(tests, encoding="utf-8")
    (tmp_path / "test_single.py").write_text("def test_alone(): pass\n", encoding="utf-8")
    shared = ("--numprocesses", "1", "--dist", "loadscope", "--no-loadscope-reorder")
    told = run(tmp_path, *shared)
    assert "1 failed, 6 passed" in told.splitlines()[-1], told


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX timers")
def test_one_that_computes_for_ever_is_ended_by_its_processor_time(tmp_path):
    (tmp_path / "test_one.py").write_text(COMPUTES, encoding="utf-8")
    assert "0.2 s of processor time" in run(tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
def test_one_that_fails_ends_what_it_started_whatever_signals_the_caller_ignores(tmp_path):
    def ignore():
        for number in (signal.SIGINT, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)

    (tmp_path / "test_one.py").write_text(LEAVES, encoding="utf-8")
    told = run(tmp_path, preexec_fn=ignore)
    assert "1 failed, 1 passed" in told.splitlines()[-1], told
    for left in map(int, (tmp_path / "left").read_text().split()):
        gone = not psutil.pid_exists(left)
        assert gone or psutil.Process(left).status() == psutil.STATUS_ZOMBIE
