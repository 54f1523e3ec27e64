"""The built extension in a real Blender: it installs, registers, and goes without a trace."""

import json
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
OPERATORS = ["add_sensor", "score", "optimize", "export_study", "render_review"]


@pytest.fixture(scope="module")
def report(installed, tmp_path_factory):
    """Return what is registered after installing, after disabling and after enabling again."""
    path = tmp_path_factory.mktemp("package") / "report.json"
    answer = installed.script(HERE / "inside_package.py", path)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "Traceback" not in answer.stderr, answer.stderr
    return json.loads(path.read_text())


def test_operators_exist(report):
    assert report["registered"]["operators"] == OPERATORS


def test_properties_exist(report):
    assert {"Scene", "Object"} <= set(report["registered"]["properties"])


def test_unregister_leaves_nothing(report):
    assert report["unregistered"] == {
        "classes": [],
        "handlers": [],
        "properties": [],
        "operators": [],
    }


def test_register_again_is_the_same(report):
    assert report["again"] == report["registered"]


def test_engine_is_the_one_inside(report):
    assert report["pe_core"], "the extension did not load its own pe_core"
    assert all("user_default" in path for path in report["pe_core"]), report["pe_core"]
