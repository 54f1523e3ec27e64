"""What the add-on's modules may import, held against every import."""

import ast
import graphlib
import itertools
import re
from pathlib import Path

import blender_addon
from blender_addon import engine
from tests.engine.source_trees import imported, nodes_of, tree_of

ROOT = Path(blender_addon.__file__).parent
PACKAGE = "blender_addon"
CALLS = {
    "processes.analysis_calls",
    "processes.engine_calls",
    "processes.own_jobs",
    "sensor_kinds",
    "view.view_settings",
}
"""What the engine's process runs."""
ARRAYS = CALLS | {
    f"overlay.{name}"
    for name in (
        "annotations",
        "ground_layers",
        "heatmap",
        "layer_cache",
        "layers",
        "regions",
        "request",
    )
}
"""Modules that need neither a scene nor a GPU."""

ARROWS = """
engine:
signals:
choices:
sensor_kinds: engine
library:
panel_text: choices
document: choices engine sensor_kinds
processes.engine_calls: engine
caches: document engine signals
view: caches choices document engine panel_text sensor_kinds
properties: caches choices document engine sensor_kinds signals view
overlay: choices engine processes.engine_calls view
processes: engine overlay processes.engine_calls
queries: caches choices document engine processes signals view
preferences: engine library panel_text processes properties signals
live: caches choices document engine panel_text processes processes.engine_calls signals view
overlay.snapshot: caches choices document engine live overlay processes.engine_calls queries view
overlay.scheduler: caches engine overlay overlay.snapshot processes view
overlay.surroundings: engine overlay view
overlay.draw_handler: caches document engine overlay overlay.scheduler overlay.surroundings
    panel_text processes queries view
operators: caches choices document engine library live overlay overlay.scheduler
    overlay.surroundings panel_text preferences processes processes.engine_calls properties queries
    sensor_kinds signals view
panels: caches choices document engine live operators panel_text properties queries sensor_kinds
commands: caches document engine view
wiring: caches document live operators overlay.draw_handler overlay.scheduler processes queries
    signals view
__main__: __init__ commands engine
__init__: caches commands library live operators overlay.draw_handler panels preferences processes
    properties queries view wiring
"""
"""What each module or package may import. What stands below a package is part of it, unless it has
a line of its own."""
ALLOWED = {
    name: set(to.split())
    for name, to in re.findall(r"^(\w[\w.]*):((?:.*\n)(?:    .*\n)*)", ARROWS, re.M)
}
ARRAY_TYPES = {"Flags", "Floats", "Ints", "Singles"}
"""Types of arrays: every module's annotations name them."""


def files():
    """Yield every file of the add-on with its name: ``overlay.draw_handler``, ``document``.

    Copies of the engine and the tools are there while the extension is built.
    """
    for path in sorted(ROOT.rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        if parts[0] not in ("pe_core", "pe_tools"):
            yield (
                ".".join(parts[:-1] if len(parts) > 1 and parts[-1] == "__init__" else parts),
                path,
            )


FILES = dict(files())


def unit_of(name):
    """The line of the table that a module belongs to; itself when there is none."""
    units = [unit for unit in ALLOWED if name == unit or name.startswith(f"{unit}.")]
    return max(units, key=len, default=name)


def imported_files(path, root=ROOT.parent):
    """Yield the names of the add-on's own files that a file imports."""
    for full in imported(path, root):
        top, _, inner = full.partition(".")
        if top == PACKAGE:
            while inner and inner not in FILES:
                inner = inner.rpartition(".")[0]
            yield inner or "__init__"


def edges():
    """All (from, to) between lines of the table."""
    pairs = {(unit_of(n), unit_of(to)) for n, path in FILES.items() for to in imported_files(path)}
    return {(a, b) for a, b in pairs if a != b}


def test_every_import_goes_along_an_arrow():
    assert {unit_of(name) for name in FILES} == set(ALLOWED)
    found = edges()
    wrong = sorted(f"{a} -> {b}" for a, b in found if b not in ALLOWED[a])
    assert not wrong
    unused = sorted(f"{a} -> {b}" for a, to in ALLOWED.items() for b in to if (a, b) not in found)
    assert not unused, "the table promises less freedom than it gives"


def test_the_page_has_a_row_for_each_line_of_the_table():
    lines = (ROOT.parent / "ARCHITECTURE.md").read_text("utf-8").splitlines()
    start = lines.index("## blender_addon") + 4
    rows = itertools.takewhile(lambda line: line.startswith("|"), lines[start:])
    named = [name for row in rows for name in re.findall(r"`([\w.]+)/?`", row.split("|")[1])]
    assert sorted(named) == sorted(set(ALLOWED) - {"__init__"})


def test_arrows_point_one_way():
    graphlib.TopologicalSorter(ALLOWED).prepare()


def test_imports_are_seen_wherever_they_stand(tmp_path):
    """The test above is worth what it sees: inside functions, and by every way to write them."""
    path = tmp_path / PACKAGE / "operators" / "job.py"
    path.parent.mkdir(parents=True)
    path.write_text(
        "from .. import signals as s, document\n"
        "from ..overlay import draw_handler\n"
        "def f():\n    from . import running_job\n    import blender_addon.overlay.labels\n"
    )
    expected = ["signals", "document", "overlay.draw_handler"]
    expected += ["operators.running_job", "overlay.labels"]
    assert list(imported_files(path, tmp_path)) == expected
    face = path.with_name("__init__.py")
    face.write_text("from .job import x\nfrom ..engine import pe\n")
    assert list(imported_files(face, tmp_path)) == ["operators", "engine"]


def packages_imported(name):
    """The top-level packages that a file imports."""
    return {full.partition(".")[0] for full in imported(FILES[name])}


def test_the_document_is_taken_by_its_face():
    offenders = [
        f"{name}: {to}"
        for name, path in FILES.items()
        if unit_of(name) != "document"
        for to in imported_files(path)
        if to.startswith("document.")
    ]
    assert not offenders


def test_what_the_engine_s_process_runs_needs_neither_scene_nor_gpu():
    blender = {"bpy", "gpu", "gpu_extras", "mathutils", "bpy_extras"}
    assert not [name for name in sorted(ARRAYS) if packages_imported(name) & blender]


def test_the_engine_comes_through_its_door():
    around = [name for name in FILES if packages_imported(name) & {"pe_core", "pe_tools"}]
    assert around == ["engine"]
    late = [name for name in FILES if "importlib" in packages_imported(name)]
    assert late == ["engine"]


def test_nothing_has_a_thread():
    """What computes runs in the engine's process."""
    threads = {"threading", "_thread", "concurrent", "queue", "asyncio", "multiprocessing"}
    assert not [name for name in FILES if packages_imported(name) & threads]


def rooms():
    """The engine's modules that the door has, by the name they have there."""
    return {name: getattr(engine, name) for name in (*engine.ROOMS, "pe")}


def test_the_door_leads_into_rooms_only():
    for name, room in rooms().items():
        is_room = hasattr(room, "__path__") or room.__name__.count(".") == 1
        assert is_room, f"{name} is {room.__name__}, inside a room"
        assert room.__name__.count(".") <= 2, f"{name} is {room.__name__}, inside a room"


def public_names(room):
    """What a room shows: its ``__all__``; without one, what does not begin with an underscore."""
    return set(getattr(room, "__all__", (n for n in dir(room) if not n.startswith("_"))))


def beside_the_faces(tree):
    """Yield what a source takes from the engine that no room shows."""
    taken = {
        alias.asname or alias.name: alias.name
        for node in nodes_of(tree)
        if isinstance(node, ast.ImportFrom) and node.module == "engine"
        for alias in node.names
    }
    yield from set(taken.values()) - set(rooms()) - ARRAY_TYPES
    for node in nodes_of(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            room = rooms().get(taken.get(node.value.id))
            if room is not None and node.attr not in public_names(room):
                yield f"{room.__name__}.{node.attr}"


def test_only_the_faces_of_rooms_are_used():
    offenders = {
        name: found
        for name, path in FILES.items()
        if (found := sorted(beside_the_faces(tree_of(path))))
    }
    assert not offenders


def test_the_rule_of_faces_catches_what_goes_deeper():
    source = "from .engine import pe, bogus\npe.Study, pe.nothing_of_the_kind\n"
    assert sorted(beside_the_faces(ast.parse(source))) == ["bogus", "pe_core.nothing_of_the_kind"]
