"""The engine's rooms: what each may import, and that nothing else is imported."""

import ast
import functools
import subprocess
import sys
from pathlib import Path

import pe_core

ROOT = Path(pe_core.__file__).parent
FILES = sorted(ROOT.rglob("*.py"))

ALLOWED = {
    "errors": set(),
    "version": set(),
    "text": {"errors"},
    "metric": {"errors", "text"},
    "scene": {"errors", "text", "metric"},
    "prior": {"errors", "text", "scene"},
    "kinds": {"errors", "text", "metric", "scene"},
    "formats": {"errors", "text", "metric", "scene", "prior", "kinds"},
    "scoring": {"errors", "text", "metric", "scene", "prior", "kinds"},
    "targets": {"errors", "text", "metric", "scene", "prior", "kinds", "scoring"},
    "sight": {"errors", "text", "metric", "scene", "prior", "kinds", "scoring", "targets"},
    "graphics": {"errors", "scene", "kinds", "scoring", "sight"},
    "search": {"errors", "text", "scene", "scoring"},
    "catalog": {"errors", "text", "scene", "kinds"},
    "exchange": {"errors", "text", "scene", "kinds", "catalog"},
    "advice": {
        *("errors", "text", "metric", "scene", "prior", "kinds", "scoring", "sight", "catalog"),
    },
    "study": {
        *("errors", "version", "text", "metric", "scene", "prior", "kinds"),
        *("formats", "scoring", "targets", "sight", "search", "catalog", "advice", "exchange"),
    },
    "outputs": {
        *("errors", "version", "text", "scene", "kinds", "sight", "graphics"),
        *("exchange", "study"),
    },
    "sweep": {"errors", "version", "text", "scene", "study"},
    "public": {
        *("errors", "version", "metric", "scene", "prior", "kinds", "formats", "scoring"),
        *("targets", "sight", "search", "catalog", "exchange", "advice", "study"),
    },
    "app": {
        *("errors", "version", "text", "scene", "kinds", "formats", "catalog", "exchange", "sight"),
        *("advice", "search", "study", "outputs", "sweep"),
    },
    "__main__": {"app"},
}
"""Rooms of the engine, lowest first, and those they may look into: all of them further up here."""


def nodes(path):
    """Every node of a file's syntax tree."""
    return nodes_of(path.read_text("utf-8"))


@functools.cache
def nodes_of(source):
    """Every node of a source's syntax tree; parsed once however many tests ask."""
    return tuple(ast.walk(ast.parse(source)))


def imports(path):
    """(level, dotted module, name) of every import in a file, inside functions too."""
    for node in nodes(path):
        if isinstance(node, ast.Import):
            yield from ((0, alias.name, "") for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.level, node.module or "", alias.name) for alias in node.names)


def room_of(path):
    """The room that a file is in, or the name of a file that is beside them."""
    return path.relative_to(ROOT).with_suffix("").parts[0]


def rooms_imported(path):
    """Rooms that a file imports from, whichever way it is written."""
    package = path.relative_to(ROOT).parts[:-1]
    for level, module, name in imports(path):
        if level == 0:
            continue
        parts = [*package[: len(package) - (level - 1)], *filter(None, module.split(".")), name]
        yield parts[0]


def test_imports_are_numpy_the_standard_library_or_relative():
    allowed = sys.stdlib_module_names | {"numpy"}
    offenders = [
        f"{path.relative_to(ROOT)}: {module}"
        for path in FILES
        for level, module, _ in imports(path)
        if level == 0 and module.split(".")[0] not in allowed
    ]
    assert not offenders


def test_rooms_look_only_into_rooms_below_them():
    offenders = [
        f"{path.relative_to(ROOT)}: {room}"
        for path in FILES
        if room_of(path) != "__init__"  # the public face of it all
        for room in set(rooms_imported(path)) - {room_of(path)} - ALLOWED[room_of(path)]
    ]
    assert not offenders


def test_optional_packages_are_looked_for_in_one_place():
    """What is imported by a name that is made while running, the test above does not see."""
    callers = {
        str(path.relative_to(ROOT))
        for path in FILES
        for node in nodes(path)
        if isinstance(node, ast.Name) and node.id in ("import_module", "__import__")
    }
    own_modules = {"__init__.py", "search/processes.py"}
    assert callers == own_modules | {"app/extras.py"}


def test_every_room_is_in_the_list_and_arrows_run_one_way():
    rooms = {room_of(path) for path in FILES} - {"__init__"}
    assert rooms == set(ALLOWED)
    above = list(ALLOWED)
    for number, room in enumerate(above):
        assert ALLOWED[room] <= set(above[:number]), room


def test_the_check_sees_every_way_to_write_an_import(tmp_path, monkeypatch):
    """Modules from a package, packages from the root, imports inside functions."""
    monkeypatch.setattr(sys.modules[__name__], "ROOT", tmp_path)
    path = tmp_path / "kinds" / "lidar" / "odd.py"
    path.parent.mkdir(parents=True)
    path.write_text(
        "from ... import study\n"
        "from ...scoring.score import Score\n"
        "from ..kernels import Voxels\n"
        "def late():\n    from ...app import cli\n"
    )
    assert set(rooms_imported(path)) == {"study", "scoring", "kinds", "app"}


def test_a_sensor_s_kind_is_asked_of_the_table_alone():
    """Outside a kind's own folder nobody tells LiDARs from cameras by class or by name."""
    for path in FILES:
        inside = path.relative_to(ROOT).parts
        if inside[:2] in (("kinds", "lidar"), ("kinds", "camera")) or len(inside) == 1:
            continue
        if inside == ("exchange", "carried.py"):  # other programs' files know these two alone
            continue
        if inside[0] == "graphics":  # a table by kind's name, and what its rows call
            continue
        named = {name for _, _, name in imports(path)} & {"Lidar", "Camera"}
        texts = {node.value for node in nodes(path) if isinstance(node, ast.Constant)} & {
            "lidar",
            "camera",
        }
        assert inside == ("kinds", "__init__.py") or not named | texts, path


def test_importing_the_engine_loads_no_numpy_until_a_name_is_asked_for():
    code = (
        "import sys, pe_core as pe; assert 'numpy' not in sys.modules; pe.Study; "
        "assert 'numpy' in sys.modules; assert set(pe.__all__) <= set(dir(pe)); "
        "assert all(hasattr(pe, n) for n in (*pe.__all__, 'scene', 'study')); "
        "assert not hasattr(pe, 'bogus')"
    )
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT.parent).returncode == 0


def test_importing_the_engine_loads_no_blender():
    code = (
        "import sys, pe_core; sys.exit(any(m in sys.modules for m in ('bpy', 'mathutils', 'gpu')))"
    )
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT.parent).returncode == 0
