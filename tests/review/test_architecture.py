"""What the page may import: NumPy, the standard library, itself, and the engine by one door."""

import ast
import subprocess
import sys
from pathlib import Path

import pe_review
from tests.engine.test_architecture import imports
from tests.report.test_architecture import is_public, taken

FOLDER = Path(pe_review.__file__).parent
FILES = sorted(FOLDER.rglob("*.py"))
DOORS = (FOLDER / "engine.py", FOLDER / "__init__.py")
"""The engine's, and the package's own, whose names are loaded when asked for."""


def is_type_checking(node):
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def run_time_part(source):
    """A source without what only a type checker reads."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if is_type_checking(node):
            node.body = [ast.Pass()]
    return ast.unparse(tree)


def beside_the_libraries(path, folder):
    """What a file imports at run time that is neither NumPy, the standard library nor relative."""
    copy = folder / "copy.py"
    copy.write_text(run_time_part(path.read_text("utf-8")))
    tops = {module.split(".")[0] for level, module, _ in imports(copy) if level == 0}
    by_name = {"importlib"} & tops if path not in DOORS else set()
    return sorted(tops - (sys.stdlib_module_names | {"numpy"}) | by_name)


def test_imports_are_numpy_the_standard_library_or_relative(tmp_path):
    """The engine lies elsewhere in Blender's extension: it is taken through the door alone."""
    offenders = {path: found for path in FILES if (found := beside_the_libraries(path, tmp_path))}
    assert not offenders


def beside_the_faces(path):
    """Yield what a file takes from the engine that no room shows."""
    source = path.read_text("utf-8")
    if path not in DOORS:
        yield from (pair for pair in taken(source) if not is_public(*pair))
    from pe_review import engine

    tree = ast.parse(source)
    doors = {
        alias.asname or alias.name: getattr(engine, alias.name)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.level and node.module == "engine"
        for alias in node.names
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            room = doors.get(node.value.id)
            if room is not None and node.attr not in room.__all__:
                yield f"{room.__name__}.{node.attr}"


def test_only_public_faces_are_used():
    """Of the engine's rooms, by their names on the door, too."""
    assert not {path: found for path in FILES if (found := list(beside_the_faces(path)))}


def test_sections_are_found_by_the_table_alone():
    """A section knows nothing of another, nor of the page."""
    for path in (FOLDER / "sections").glob("*.py"):
        if path.name != "__init__.py":
            names = {module for level, module, _ in imports(path) if level}
            assert not names & {"page", "sections", "making", "cli"}, path


def test_the_parser_loads_no_section():
    code = (
        "import sys; from pe_core.app.cli import parser; parser(); "
        "from pe_review.cli import add_page; add_page(); "
        "print(*sorted(m for m in sys.modules if m.startswith('pe_review')))"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], cwd=FOLDER.parent, capture_output=True, text=True
    )
    assert run.stdout.split() == ["pe_review", "pe_review.cli", "pe_review.engine"], run.stderr


def test_the_copy_in_the_extension_takes_the_engine_beside_it(tmp_path):
    """And no other: Blender lets no add-on bring packages of the highest level."""
    (tmp_path / "extension").mkdir()
    (tmp_path / "extension" / "__init__.py").touch()
    for name in ("pe_core", "pe_review"):
        (tmp_path / "extension" / name).symlink_to(FOLDER.parent / name)
    code = (
        "import sys; import extension.pe_review.page, extension.pe_review.making; "
        "print(*sorted(m for m in sys.modules if m in ('pe_core', 'pe_review')))"
    )
    run = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert (run.returncode, run.stdout.strip()) == (0, ""), run.stdout + run.stderr
