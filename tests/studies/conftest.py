"""The studies' commands, and one quick reproduction for all tests that look at it."""

import contextlib
import io
import json
import runpy
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import pytest

ROOT = Path(__file__).parents[2]


def study(name, *arguments):
    """Run a study's command in this process: what it prints, warnings too, and its status."""
    out, err = io.StringIO(), io.StringIO()
    streams = contextlib.redirect_stdout(out), contextlib.redirect_stderr(err)
    argv = [name, *map(str, arguments)]
    names = f"studies.{name}", f"studies.{name}.__main__"  # by a test: Python would warn
    of_tests = {n: m for n in names if not hasattr(m := sys.modules.get(n, sys), "__path__")}
    of_tests = {n: sys.modules.pop(n) for n, m in of_tests.items() if m is not sys}
    with streams[0], streams[1], warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("default")
        with mock.patch.object(sys, "argv", argv), pytest.raises(SystemExit) as ended:
            runpy.run_module(f"studies.{name}", run_name="__main__")
    sys.modules.update(of_tests)
    said = "".join(f"{each.category.__name__}: {each.message}\n" for each in warned)
    text = err.getvalue() + said
    return SimpleNamespace(returncode=ended.value.code, stdout=out.getvalue(), stderr=text)


def numbers(data):
    """All numbers of JSON data."""
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list):
        return [n for value in data for n in numbers(value)]
    return [data] if isinstance(data, (int, float)) and not isinstance(data, bool) else []


@pytest.fixture(scope="session")
def quick(tmp_path_factory):
    """The folder, the data and the run of ``python -m studies.paper --quick``."""
    folder = tmp_path_factory.mktemp("reproduction")
    run = study("paper", "--quick", "--output", folder)
    assert run.returncode == 0, run.stdout + run.stderr
    data = json.loads((folder / "results.json").read_text("utf-8"))
    return SimpleNamespace(folder=folder, data=data, run=run)
