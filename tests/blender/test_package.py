"""The built extension in a real Blender: it registers, speaks, and goes without a trace."""

import json
from pathlib import Path

import pytest

from tests.blender.runner import output_of

HERE = Path(__file__).resolve().parent
OPERATORS = ["add_sensor", "score", "optimize", "export_file", "import_file"]


@pytest.fixture(scope="module")
def report(installed, tmp_path_factory):
    """Return what is registered after installing, after disabling and after enabling again."""
    path = tmp_path_factory.mktemp("package") / "report.json"
    answer = installed.script(HERE / "inside_package.py", path)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    assert "Traceback" not in answer.stderr, answer.stderr
    return json.loads(path.read_text())


def test_it_registers_goes_without_a_trace_and_comes_back(report):
    assert report["registered"]["operators"] == OPERATORS
    assert {"Scene", "Object"} <= set(report["registered"]["properties"])
    assert not any(report["unregistered"].values())
    assert report["again"] == report["registered"]


@pytest.mark.parametrize("code", ("de", "ja", "zh"))
def test_names_stay_english_where_blender_has_a_translation(report, code):
    """More than twenty of our names are also in Blender's catalogue."""
    found = report["translated"][code]
    assert found["names"] > 400 and len(found["in_blender_s"]) > 20
    assert not found["in_our_context"]


def test_blender_s_own_tool_finds_the_zip_valid(blender, extension_zip):
    answer = blender.run(["--factory-startup", "--command", "extension", "validate", extension_zip])
    assert answer.returncode == 0, output_of(answer)


def test_engine_is_the_one_inside(report):
    assert report["pe_core"], "the extension did not load its own pe_core"
    assert all("user_default" in path for path in report["pe_core"]), report["pe_core"]
