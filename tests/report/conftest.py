"""One quick reproduction for all tests that look at it."""

import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

ROOT = Path(__file__).parents[2]


def pe(*arguments, cwd=ROOT):
    """Run the command."""
    command = [sys.executable, "-m", "pe_core", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=600)


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
