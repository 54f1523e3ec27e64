"""The command on a .blend file: in this process, or in one of its own where that is the point."""

import contextlib
import io
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import bpy

from blender_addon.__main__ import run_on_file
from pe_tools.cli import verbs
from tests.limits import HANG_S

ROOT = Path(__file__).resolve().parents[2]
FAST = (
    "--samples",
    "1024",
    "--set",
    "optimize.samples=1024",
    "--method",
    "random",
    "--set",
    "optimize.candidates=2",
    "--seed",
    "3",
)


class Answer(NamedTuple):
    """What a command returned and printed."""

    returncode: int
    stdout: str
    stderr: str


def run_here(blend, arguments) -> Answer:
    """``python -m blender_addon FILE VERB`` in this process; the file is open afterwards, as saved.

    Objects of the scene that was open before are gone.
    """
    out = io.StringIO()
    err = io.StringIO()
    argv = [str(each) for each in (blend, *arguments)]
    with contextlib.redirect_stderr(err):
        status = run_on_file(argv, out)
    if Path(bpy.data.filepath) == Path(blend):
        bpy.ops.wm.open_mainfile(filepath=str(blend))
    return Answer(status, out.getvalue(), err.getvalue())


def pe_here(arguments) -> Answer:
    """``pe VERB`` in this process."""
    out = io.StringIO()
    err = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = verbs.main([str(each) for each in arguments])
    return Answer(status, out.getvalue(), err.getvalue())


def same_in_both(folder, verb, options) -> dict:
    """What a verb says of the scene in Blender, and of its exported study without: the same."""
    blend = folder / "car.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))
    assert run_here(blend, ["export", "-o", folder / "study"]).returncode == 0
    inside = run_here(blend, [verb, *options, "--json"])
    outside = pe_here([verb, folder / "study" / "study.toml", *options, "--json"])
    assert inside.stdout == outside.stdout and inside.returncode == outside.returncode == 0
    return json.loads(inside.stdout)


def command(blend, arguments) -> list[str]:
    """The command as a user types it."""
    return [sys.executable, "-m", "blender_addon", *map(str, (blend, *arguments))]


def run_alone(blend, arguments) -> Answer:
    """``python -m blender_addon FILE VERB`` in a process of its own."""
    # The bpy of this process has set OCIO; another one would tell of it on stdout.
    env = {key: value for key, value in os.environ.items() if key != "OCIO"}
    options = {"capture_output": True, "text": True, "timeout": HANG_S}
    answer = subprocess.run(command(blend, arguments), cwd=ROOT, env=env, **options)
    return Answer(answer.returncode, answer.stdout, answer.stderr)


def complaints(answer) -> list[str]:
    """The lines of stderr that are no progress."""
    return [line for line in answer.stderr.splitlines() if line.startswith("pe: ")]


def wait_for(text: str, log: Path) -> None:
    """Wait until a running command has written a text to its log."""
    deadline = time.monotonic() + HANG_S
    while text not in log.read_text():
        assert time.monotonic() < deadline, log.read_text()
        time.sleep(0.1)
