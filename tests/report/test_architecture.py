"""What is built on the engine takes its public faces: `pe_core` and its rooms, never deeper."""

import ast
import importlib
import subprocess
import sys

import pytest

from tests.report.conftest import ROOT

FOLDERS = ("pe_report", "benchmarks", "blend_assets", "tools")
FILES = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))
ROOMS = {path.parent.name for path in (ROOT / "pe_core").glob("*/__init__.py")}


def taken(source):
    """(module, name) of all that a source takes from the engine; name "" for a bare import."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            pairs = [(alias.name, "") for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            pairs = [(node.module, alias.name) for alias in node.names]
        else:
            continue
        yield from ((module, name) for module, name in pairs if module.split(".")[0] == "pe_core")


def is_public(module, name):
    """Whether a module is the engine or one of its rooms, and the name on its face."""
    room = module.removeprefix("pe_core").removeprefix(".")
    if room not in {"", *ROOMS} or (room and not name):
        return False
    return not name or name in importlib.import_module(module).__all__


def test_only_public_faces_are_imported():
    offenders = [
        f"{path.relative_to(ROOT)}: {module} {name}"
        for path in FILES
        for module, name in taken(path.read_text("utf-8"))
        if not is_public(module, name)
    ]
    assert not offenders


@pytest.mark.parametrize(
    "line",
    [
        "import pe_core.metric.entropy",
        "import pe_core.metric",
        "from pe_core.metric.entropy import H_BLIND",
        "from pe_core.metric import entropy",
        "from pe_core import metric",
        "from pe_core.errors import InputError",
        "from pe_core.text.files import read_bytes",
        "from pe_core.metric import *",
        "def late():\n    from pe_core.scoring.sampling import draw",
    ],
)
def test_the_rule_catches_what_goes_deeper(line):
    found = list(taken(line))
    assert found and not all(is_public(module, name) for module, name in found)


def test_the_report_is_found_to_use_the_engine():
    """The rule has something to look at: the names below are taken today."""
    found = {pair for path in FILES for pair in taken(path.read_text("utf-8"))}
    assert {("pe_core", ""), ("pe_core.metric", "H_BLIND"), ("pe_core.scoring", "draw")} <= found


def test_the_parser_loads_neither_the_experiments_nor_matplotlib():
    """`pe sensors` does not wait for what it does not use."""
    code = (
        "import sys; from pe_core.app.cli import parser; parser(); "
        "print(*sorted(m for m in sys.modules if m.startswith(('pe_report', 'matplotlib'))))"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert run.stdout.split() == ["pe_report", "pe_report.cli"]
