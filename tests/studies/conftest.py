"""The studies' commands, and one quick reproduction for all tests that look at it."""

import contextlib
import io
import json
import runpy
import sys
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import pytest

import pe_tools as pt
from pe_core import InputError
from pe_core.search.key_figures import KeyFigures
from studies import plotting, results_file

ROOT = Path(__file__).parents[2]


def study(name, *arguments):
    """Run a study's command in this process: what it prints, warnings too, and its status."""
    out = io.StringIO()
    err = io.StringIO()
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


def no_figures(*_):
    """In place of key figures, which take longer than a short search, and which no study reads."""
    raise InputError("space", "z", "the ground", "none")


def search_alone(patch):
    """Have a search end with its result: no study reads what is analysed of it."""
    patch.setattr(KeyFigures, "of_rig", no_figures)
    patch.setattr(pt.OptimizeJob, "_robustness", lambda *_: None)
    patch.setattr(pt.OptimizeJob, "analyses", False)


def quick_run(name, folder):
    """The folder, the data and the run of a study's ``--quick``, its tasks in this process."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(results_file, "Processes", lambda _: ThreadPoolExecutor(1))
        search_alone(patch)
        patch.setitem(plotting.STYLE, "savefig.dpi", 30)
        run = study(name, "--quick", "--output", folder)
    assert run.returncode == 0, run.stdout + run.stderr
    data = json.loads((folder / "results.json").read_text("utf-8"))
    return SimpleNamespace(folder=folder, data=data, run=run)


@pytest.fixture(scope="module")
def quick(request, tmp_path_factory):
    """The quick run of the study that the module names."""
    return quick_run(request.module.STUDY, tmp_path_factory.mktemp("quick"))
