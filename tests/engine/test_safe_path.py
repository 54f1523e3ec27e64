"""No file beside a study is run as a module: neither by the command nor by its processes."""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from pe_tools.cli.verbs import VERBS as DECLARED
from tests.limits import HANG_S
from tests.thorough import THOROUGH

PE = Path(sysconfig.get_path("scripts"), f"pe{'.exe' if sys.platform == 'win32' else ''}")
LIBRARIES = "numpy ruamel trimesh pe_core pe_tools usercustomize sitecustomize"
TRAP = """
import os
with open({found!r}, "a") as file:
    file.write(__name__ + chr(10))
"""
SEARCH = ["--evaluations", "12", "--no-review", "--workers", "2"]
FEW = ["--samples", "1024"]
VERBS = {
    "sensors": [],
    "new": ["car.npz", "-o", "first.toml"],
    "set": ["car.toml", "samples=1024"],
    "score": ["car.toml", *FEW, "-o", "scored"],
    "explain": ["car.toml", *FEW],
    "check": ["car.toml", "--preset", "r159_crossing"],
    "compare": ["car.toml", "car.toml", *FEW],
    "where": ["car.toml", "--model", "Pandar40", "--places", "4", "--workers", "2"],
    "optimize": ["car.toml", *FEW, *SEARCH, "-o", "found"],
    "sweep": ["car.toml", *FEW, "--set", "optimize.seed=0,1", "--workers", "2", "-o", "runs"],
    "export": ["car.toml", "-o", "car.urdf"],
    "import": ["rig.csv", "-o", "imported.toml"],
    "review": ["car.toml", *FEW, "-o", "page"],
    "region": ["car.toml", "roof", "--places", "4", "--workers", "2", "--set", "samples=1024"],
    "serve": [],
    "verify": [],
}
"""What each verb is given: for `optimize` and `sweep` two worker processes."""
BEGINNINGS = {"pe": [PE], "-P": [sys.executable, "-P", "-m", "pe_tools"]}
FEW_CALLS = [("pe", "sweep"), ("pe", "serve"), ("-P", "optimize")]
CALLS = [*(("pe", verb) for verb in VERBS), *FEW_CALLS[-1:]] if THOROUGH else FEW_CALLS
"""By default those that start workers, and one that waits for lines."""
STARTS_ENGINE = """
import os, time
from pe_tools.engine_process import EngineProcess
engine, answers = EngineProcess(dict), []
engine.ask("folder", os.getcwd, (), answers.append, answers.append)
while engine.deliver_all():
    time.sleep(0.01)
engine.stop()
assert answers == [os.getcwd()], answers
"""
STARTS_WORKERS = """
import os
from pe_core.search import start_processes
workers = start_processes(2)
assert workers is not None
assert workers.submit(os.getcwd).result() == os.getcwd()
workers.shutdown()
"""
EXECUTOR = """
from concurrent.futures import ThreadPoolExecutor
def pool():
    import wave
    return ThreadPoolExecutor(1)
"""


@pytest.fixture
def trapped(study, tmp_path):
    """Return the folder of a study, with a trap for each module that could be imported."""
    traps = {*sys.stdlib_module_names, *LIBRARIES.split(), "sensors", "study"}
    for name in traps:
        (tmp_path / f"{name}.py").write_text(TRAP.format(found=str(tmp_path / "found.txt")))
    info = tmp_path / "trap-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: trap\nVersion: 1.0\n")
    points = "[perception_entropy]\nverb_trap = sensors:trap\n"
    (info / "entry_points.txt").write_text(points)
    (tmp_path / "table.csv").write_text("m,ap\n1,0.2\n10,0.5\n100,0.8\n1000,0.9\n")
    return tmp_path


@pytest.fixture
def script_elsewhere(tmp_path_factory):
    """Return what writes a script into another folder, as the command `pe` is in one: ``-c`` would
    put the current folder first."""

    def write(text):
        script = tmp_path_factory.mktemp("elsewhere") / "script.py"
        script.write_text(text)
        return script

    return write


def run_in(folder, command):
    """Run a command in a folder; return its status and what it said."""
    env = {name: text for name, text in os.environ.items() if name != "PYTHONSAFEPATH"}
    env["PYTHONDONTWRITEBYTECODE"] = "1"
    options = {"capture_output": True, "text": True, "timeout": HANG_S, "env": env}
    done = subprocess.run(list(map(str, command)), cwd=folder, **options)
    return done.returncode, done.stdout + done.stderr


def sprung(folder):
    """Return the names of the modules that were run from a folder."""
    found = folder / "found.txt"
    return found.read_text().split() if found.exists() else []


def test_every_verb_has_a_trap():
    """A verb that is new is tried, too."""
    assert set(VERBS) == {verb.name for verb in DECLARED}


@pytest.mark.parametrize(("begin", "verb"), CALLS)
def test_no_verb_runs_a_file_of_the_current_folder(begin, verb, trapped):
    if verb == "import":
        assert run_in(trapped, [PE, "export", "car.toml", "-o", "rig.csv"])[0] == 0
    status, said = run_in(trapped, [*BEGINNINGS[begin], verb, *VERBS[verb]])
    assert status in (0, 3), said
    assert sprung(trapped) == []


@pytest.mark.parametrize("script", [STARTS_ENGINE, STARTS_WORKERS], ids=["engine", "workers"])
def test_no_process_runs_a_file_of_the_current_folder(script, trapped, script_elsewhere):
    """Also where the program that starts it was begun in another way; the tracker of semaphores
    starts with the workers."""
    status, said = run_in(trapped, [sys.executable, script_elsewhere(script)])
    assert status == 0, said
    assert sprung(trapped) == []
    run_in(trapped, [sys.executable, "-c", "import pickle"])
    assert sprung(trapped), "the traps work"


def test_the_variable_is_as_before_after_a_start(trapped, script_elsewhere):
    """A process that the host starts later is not changed by ours."""
    script = STARTS_WORKERS + "assert 'PYTHONSAFEPATH' not in os.environ\n"
    status, said = run_in(trapped, [sys.executable, script_elsewhere(script)])
    assert status == 0, said


def test_a_module_that_a_user_names_is_taken_from_there_and_no_other(trapped):
    (trapped / "mine_of_this_test.py").write_text(EXECUTOR)
    named = ["--executor", "mine_of_this_test:pool", "-o", "found"]
    status, said = run_in(trapped, [PE, "optimize", "car.toml", *FEW, *SEARCH, *named])
    assert status == 0, said
    assert sprung(trapped) == []
    assert (trapped / "found" / "result.json").exists()
