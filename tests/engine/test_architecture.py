"""The engine stands alone: NumPy, the standard library, and itself by relative imports."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import pe_core

ROOT = Path(pe_core.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))


def imported_modules(path):
    """(level, top-level name) of every import in a file, inside functions too."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from ((0, alias.name.split(".")[0]) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.level, (node.module or "").split(".")[0]


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(ROOT)))
def test_imports_are_numpy_the_standard_library_or_relative(path):
    allowed = sys.stdlib_module_names | {"numpy"}
    foreign = {name for level, name in imported_modules(path) if level == 0} - allowed
    assert not foreign


def test_importing_the_engine_loads_no_blender():
    code = (
        "import sys, pe_core; sys.exit(any(m in sys.modules for m in ('bpy', 'mathutils', 'gpu')))"
    )
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT.parent).returncode == 0


def test_kernels_do_not_know_the_layers_above():
    above = {"evaluate", "gridded", "sampled", "jobs", "study", "study_file", "cli", "command"}
    for path in (ROOT / "kernels").glob("*.py"):
        assert not {n for level, n in imported_modules(path) if level} & above, path.name
