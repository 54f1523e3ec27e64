"""The command in this process, and one quick reproduction for all tests that look at it."""

import contextlib
import io
import json
import subprocess
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import pytest

from pe_tools.cli.verbs import main

ROOT = Path(__file__).parents[2]


def pe(*arguments):
    """Run the command in this process: what it would print, warnings too, and its status."""
    out, err = io.StringIO(), io.StringIO()
    streams = contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)
    with streams[0], streams[1], warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("default")
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as ended:  # wrong usage
            status = ended.code
    said = "".join(f"{each.category.__name__}: {each.message}\n" for each in warned)
    return SimpleNamespace(returncode=status, stdout=out.getvalue(), stderr=err.getvalue() + said)


def pe_in_a_process(*arguments):
    """Run the command in a process of its own: where nothing of this one's may take part."""
    command = [sys.executable, "-m", "pe_core", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600)


def pe_without_matplotlib(*arguments):
    """Run the command where matplotlib cannot be imported."""
    code = (
        "import sys; sys.modules['matplotlib'] = None; from pe_tools.cli.verbs import main; "
        f"sys.exit(main({[str(a) for a in arguments]!r}))"
    )
    return subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)


def numbers(data):
    """All numbers of JSON data."""
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list):
        return [n for value in data for n in numbers(value)]
    return [data] if isinstance(data, (int, float)) and not isinstance(data, bool) else []


@pytest.fixture(scope="session")
def quick(tmp_path_factory):
    """The folder, the data and the run of ``pe reproduce --quick``."""
    folder = tmp_path_factory.mktemp("reproduction")
    run = pe("reproduce", "--quick", "--output", folder)
    assert run.returncode == 0, run.stdout + run.stderr
    data = json.loads((folder / "results.json").read_text("utf-8"))
    return SimpleNamespace(folder=folder, data=data, run=run)
