"""What tests of the engine and of the tools share."""

import os
import sys
import tomllib
from pathlib import Path
from types import SimpleNamespace

import pytest

import pe_core as pe
import pe_tools as pt
from pe_core.base.errors import InputError
from pe_core.base.plugins import GROUP
from pe_tools.advice import KeyFigures
from pe_tools.outputs import scene_outputs
from tests.engine import shapes
from tests.few_errors import few_errors

__all__ = ["few_errors"]
CHECKOUT = Path(__file__).parents[2]
EXAMPLE_PLUGIN = CHECKOUT / "examples" / "plugin"


@pytest.fixture
def failing_call(monkeypatch):
    """A function that has a system call fail from its n-th call on, and counts how often it did.

    With `once` only that call fails, as where another file could be removed to make room.
    """

    def fail(name, number, first=1, once=False):
        real = getattr(os, name)
        count = SimpleNamespace(calls=0, fired=0)

        def call(*args, **options):
            count.calls += 1
            if count.calls < first or (once and count.fired):
                return real(*args, **options)
            count.fired += 1
            raise OSError(number, os.strerror(number))

        monkeypatch.setattr(os, name, call)
        return count

    return fail


@pytest.fixture
def no_key_figures(monkeypatch):
    """Results without key figures, as in a space without ground: they take longer than the rest."""

    def none(*_):
        raise InputError("space", "z", "the ground", "none")

    monkeypatch.setattr(KeyFigures, "of_rig", none)


@pytest.fixture
def study(tmp_path):
    """A study file of a LiDAR on a box car, whose place and pitch a short search may change."""
    free = {"roof": ("x", "z", "pitch")}
    search = shapes.short_search(free, samples=2048, schedule=pe.Schedule(candidates=4))
    path = tmp_path / "car.toml"
    pt.export_study(shapes.car_study(shapes.roof_rig(), search=search), path)
    return path


@pytest.fixture
def out(tmp_path):
    """A folder for results that is not there yet."""
    return tmp_path / "out"


@pytest.fixture(scope="module")
def example_plugin(tmp_path_factory):
    """Return the folder that installs `examples/plugin`: its entry points, as pip writes them."""
    project = tomllib.loads((EXAMPLE_PLUGIN / "pyproject.toml").read_text("utf-8"))["project"]
    site = tmp_path_factory.mktemp("site")
    info = site / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    info.mkdir()
    head = f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    (info / "METADATA").write_text(head)
    points = "".join(f"{k} = {v}\n" for k, v in project["entry-points"][GROUP].items())
    (info / "entry_points.txt").write_text(f"[{GROUP}]\n{points}")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "path", [str(site), str(EXAMPLE_PLUGIN), *sys.path])
        scene_outputs.cache_clear()
        yield site
    scene_outputs.cache_clear()
