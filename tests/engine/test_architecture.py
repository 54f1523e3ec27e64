"""The rooms of `pe_core` and `pe_tools`: what each may import, and nothing else."""

import ast
import functools
import graphlib
import importlib
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import pe_core
from tests.engine.source_trees import imported, modules_of, nodes_of, tree_of

CHECKOUT = Path(pe_core.__file__).parent.parent
FACES = "lazy_faces"
"""What the faces of all rooms are made with."""
ROOMS = {
    "pe_core": {
        "version": set(),
        FACES: set(),
        "base": set(),
        "metric": {"base"},
        "geometry": {"base"},
        "scene": {"base", "metric", "geometry"},
        "prior": {"base", "geometry"},
        "sensors": {"base", "metric", "geometry", "scene"},
        "catalog": {"base", "geometry", "scene", "sensors"},
        "scoring": {"base", "metric", "geometry", "scene", "prior", "sensors"},
        "motion": {"base", "metric", "scene", "sensors", "scoring"},
        "search": {"base", "geometry", "scene", "sensors", "scoring"},
        "study": {
            "base",
            "metric",
            "geometry",
            "scene",
            "prior",
            "sensors",
            "catalog",
            "scoring",
            "motion",
            "search",
        },
        "public": {
            "version",
            "base",
            "metric",
            "scene",
            "prior",
            "sensors",
            "catalog",
            "scoring",
            "search",
            "study",
        },
        "__main__": set(),
    },
    "pe_tools": {
        "versions": set(),
        "templating": set(),
        "known_defects": set(),
        "formats": set(),
        "exchange": {"formats"},
        "graphics": set(),
        "engine_process": set(),
        "wording": set(),
        "advice": {"wording"},
        "jobs": {"wording", "formats", "advice"},
        "outputs": {"exchange", "graphics"},
        "sweep": {"wording", "jobs"},
        "cli": {
            "versions",
            "known_defects",
            "wording",
            "templating",
            "formats",
            "graphics",
            "exchange",
            "advice",
            "jobs",
            "outputs",
            "sweep",
        },
        "page": {"wording", "templating", "formats", "graphics", "advice", "jobs", "cli"},
        "verify": {"versions", "known_defects", "wording", "jobs", "cli"},
        "plot": {"graphics"},
        "public": {"formats", "exchange", "advice", "jobs", "plot"},
        "__main__": {"versions", "cli"},
    },
}
"""Rooms by package, lowest first, and those they may look into: all of them further up here.
`pe_tools` may also look into all of `pe_core`, and `pe_core` into nothing of `pe_tools`."""
STOREYS = 8
MAX_CHAIN_LENGTH = 30
"""Of pe_core: storeys of rooms, and files in a row of which each imports the next, at most."""
LIBRARIES = {
    "collada": {"pe_tools/formats"},
    "pxr": {"pe_tools/exchange", "pe_tools/formats"},
    "ruamel": {"pe_tools/formats"},
    "trimesh": {"pe_tools/formats"},
    "pyarrow": {"pe_tools/exchange"},
    "matplotlib": {"pe_tools/plot.py"},
}
"""Libraries besides NumPy, and the rooms in which they are imported."""
FACES_ONLY = ("benchmarks", "blend_assets", "tools")
"""Programs outside both packages: they take names from the faces of rooms."""
BY_NAME = {
    "pe_core/lazy_faces.py": "names are loaded when one is asked for",
    "pe_core/__main__.py": "the command `pe` is of the tools",
    "pe_core/base/plugins.py": "the one door to what is found at run time",
    "pe_core/base/spawning.py": "a worker's process imports the engine under its own name",
}
"""Files that import by a name made at run time, which the other tests do not see, and why."""


def files(packages):
    """Every file of our own in the packages, by its path from the checkout."""
    return {
        path.relative_to(CHECKOUT).as_posix(): path
        for package in packages
        for path in modules_of(CHECKOUT / package)
        if "_vendor" not in path.parts
    }


def nodes(path):
    """Every node of a file's syntax tree."""
    return nodes_of(tree_of(path))


def room_of(path, root=CHECKOUT):
    """The room that a file is in, or the name of a file that is beside them."""
    return path.relative_to(root).with_suffix("").parts[1]


@pytest.mark.parametrize("package", ROOMS)
def test_rooms_look_only_into_rooms_below_them(package):
    allowed = ROOMS[package]
    offenders = [
        f"{name}: {full}"
        for name, path in files([package]).items()
        if room_of(path) != "__init__"  # the public face of it all
        for full in imported(path)
        if full.startswith(f"{package}.")
        and full.split(".")[1] not in {room_of(path), FACES, *allowed[room_of(path)]}
    ]
    assert not offenders


@pytest.mark.parametrize("package", ROOMS)
def test_every_room_is_in_the_list_and_arrows_run_one_way(package):
    rooms = {room_of(path) for path in files([package]).values()} - {"__init__"}
    assert rooms == set(ROOMS[package])
    above = list(ROOMS[package])
    for number, room in enumerate(above):
        assert ROOMS[package][room] <= set(above[:number]), room


@pytest.mark.parametrize("package", ROOMS)
def test_the_page_of_the_architecture_has_a_row_for_each_room(package):
    page = (CHECKOUT / "ARCHITECTURE.md").read_text("utf-8")
    table = re.search(rf"^## {package}.*?\n\|(.*?)\n\n", page, re.S | re.M)[1]
    named = re.findall(r"`(\w+)/?`", "".join(re.findall(r"^\|(.*?) \|", table, re.M)))
    assert sorted(named) == sorted(ROOMS[package])


def test_the_engine_imports_nothing_of_the_tools():
    offenders = [
        f"{name}: {full}"
        for name, path in files(["pe_core"]).items()
        for full in imported(path)
        if full.startswith("pe_tools")
    ]
    assert not offenders


def test_libraries_are_numpy_and_those_of_a_room():
    ours = sys.stdlib_module_names | {"numpy", *ROOMS}
    offenders = [
        f"{name}: {full}"
        for name, path in files(ROOMS).items()
        for full in imported(path)
        if (top := full.split(".")[0]) not in ours
        and name.rsplit("/", name.count("/") - 1)[0] not in LIBRARIES.get(top, ())
    ]
    assert not offenders


def test_modules_are_imported_by_name_in_few_places():
    callers = {
        name
        for name, path in files(ROOMS).items()
        for node in nodes(path)
        if isinstance(node, ast.Name) and node.id in ("import_module", "__import__")
    }
    assert callers == set(BY_NAME)


def top_imports(body, *, hints):
    """Import statements at the top of a module; of type hints alone only where `hints` is set."""
    for node in body:
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
        elif isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test) and not hints:
            yield from top_imports(node.orelse, hints=hints)
        elif isinstance(node, ast.If | ast.Try):
            yield from top_imports([*node.body, *node.orelse], hints=hints)
        elif isinstance(node, ast.With):  # a face whose names are loaded when they are asked for
            yield from top_imports(node.body, hints=hints)


def import_graph(package, *, hints=False):
    """The modules of a package that each of its modules imports at its top."""
    modules = {}
    for name, path in files([package]).items():
        modules[name.removesuffix(".py").removesuffix("/__init__").replace("/", ".")] = path
    graph = {module: set() for module in modules}
    for module, path in modules.items():
        parts = module.split(".")
        own = parts if path.name == "__init__.py" else parts[:-1]
        for node in top_imports(tree_of(path).body, hints=hints):
            if isinstance(node, ast.Import):
                graph[module] |= {a.name for a in node.names} & set(modules)
                continue
            start = own[: len(own) - node.level + 1] if node.level else []
            base = ".".join([*start, *(node.module.split(".") if node.module else [])])
            for alias in node.names:
                full = f"{base}.{alias.name}"
                graph[module] |= {full if full in modules else base} & set(modules)
        graph[module].discard(module)
    return graph


def longest_path(graph):
    """The longest chain of a graph without circles of which each imports the next."""

    @functools.cache
    def below(node):
        return (node, *max((below(to) for to in graph[node]), key=len, default=()))

    return max((below(node) for node in graph), key=len)


def test_the_engine_is_low_and_its_chains_are_short():
    """A newcomer who follows imports is at the bottom soon."""
    graph = import_graph("pe_core")
    rooms = {}
    for module, to in graph.items():
        room = module.split(".")[1] if "." in module else "__init__"
        below = {name.split(".")[1] for name in to if "." in name} - {room}
        rooms.setdefault(room, set()).update(below)
    assert len(longest_path(rooms)) <= STOREYS, longest_path(rooms)
    chain = longest_path(graph)
    assert len(chain) <= MAX_CHAIN_LENGTH, "\n".join(chain)


@pytest.mark.parametrize("package", ["pe_core", "pe_tools", "blender_addon"])
def test_no_modules_import_each_other_in_a_circle(package):
    """A type hint is an arrow, too."""
    graphlib.TopologicalSorter(import_graph(package, hints=True)).prepare()


def test_a_sensor_s_kind_is_asked_of_the_table_alone():
    """Outside a kind's own folder nobody tells LiDARs from cameras by class or by name."""
    kinds = ("Lidar", "Camera", "Radar", "Ultrasonic")
    own = (*(f"pe_core/sensors/{kind.lower()}/" for kind in kinds), "pe_core/sensors/__init__.py")
    tables = (
        "pe_tools/graphics/",
        "pe_tools/page/pictures/sensor_views.py",
        "pe_tools/exchange/portable_kinds.py",
        "pe_tools/outputs/masks.py",
        "pe_tools/verify/golden_",
    )
    offenders = []
    for name, path in files(ROOMS).items():
        if name.startswith((*own, *tables)) or name.count("/") == 1:
            continue
        named = {full.rsplit(".")[-1] for full in imported(path)} & set(kinds)
        texts = {node.value for node in nodes(path) if isinstance(node, ast.Constant)}
        texts &= {kind.lower() for kind in kinds}
        if named | texts:
            offenders.append(name)
    assert not offenders


def taken(tree):
    """(module, name) of all that a source takes from the engine; "" for a bare import."""
    for node in nodes_of(tree):
        if isinstance(node, ast.Import):
            pairs = [(alias.name, "") for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            pairs = [(node.module, alias.name) for alias in node.names]
        else:
            continue
        yield from ((module, name) for module, name in pairs if module.split(".")[0] == "pe_core")


def is_public(module, name):
    """Whether a module is the engine or a room, and the name on its face."""
    package, _, room = module.partition(".")
    is_room = not room or (CHECKOUT / package / room.replace(".", "/") / "__init__.py").exists()
    if not is_room or (room and not name):
        return False
    return not name or name in dir(importlib.import_module(module))


def test_programs_outside_import_public_faces_only():
    offenders = [
        f"{name}: {module} {wanted}"
        for name, path in files(FACES_ONLY).items()
        for module, wanted in taken(tree_of(path))
        if not is_public(module, wanted)
    ]
    assert not offenders


def test_imports_load_what_is_used_alone():
    """No NumPy until a name is asked for, nothing of Blender or the tools; `pe sensors` no page."""
    code = (
        "import sys, pe_core as pe; assert 'numpy' not in sys.modules; pe.Study; "
        "assert 'numpy' in sys.modules; assert set(pe.__all__) <= set(dir(pe)); "
        "assert all(hasattr(pe, n) for n in (*pe.__all__, 'scene', 'study')); "
        "assert not hasattr(pe, 'bogus'); tops = {m.split('.')[0] for m in sys.modules}; "
        "assert not tops & {'bpy', 'mathutils', 'gpu', 'pe_tools'}, tops; "
        "from pe_tools.cli.verbs import parser; parser(['score', 'a.toml']); "
        "found = [m for m in sys.modules if m.startswith(('pe_tools.exchange', 'pe_tools.outputs', "
        "'pe_tools.formats.', 'pe_tools.jobs.optimize_job', 'asyncio', 'trimesh'))]; "
        "assert found == [], found; parser(); "
        "found = [m for m in sys.modules if m.startswith(('pe_tools.page', 'matplotlib'))]; "
        "assert found == [], found"
    )
    assert subprocess.run([sys.executable, "-c", code], cwd=CHECKOUT).returncode == 0


def test_sections_of_the_page_are_found_by_their_table_alone():
    """A section knows nothing of another, nor of the page."""
    folder = CHECKOUT / "pe_tools" / "page"
    above = {f"pe_tools.page.{name}" for name in ("page", "sections", "making", "build", "cli")}
    offenders = [
        f"{path.name}: {full}"
        for path in (folder / "sections").glob("*.py")
        if path.name != "__init__.py"
        for full in imported(path)
        if full in above or full.rpartition(".")[0] in above
    ]
    assert not offenders


def test_the_settings_of_mutants_name_files_tests_and_lines_that_there_are():
    """Whoever renames or moves a line fixes tests/mutants.toml, or drops its entry."""
    settings = tomllib.loads((CHECKOUT / "tests/mutants.toml").read_text("utf-8"))
    missing = []
    for name, room in settings["room"].items():
        missing += [(name, file) for file in room["files"] if not list(CHECKOUT.glob(file))]
        for file, _, test in (each.partition("::") for each in room["tests"]):
            path = CHECKOUT / f"tests/engine/{file}.py"
            found = path.exists() and f"def {test}" in path.read_text("utf-8")
            missing += [] if found else [(name, file, test)]
    for entry in settings["same"]:
        lines = [line.strip() for line in (CHECKOUT / entry["file"]).read_text("utf-8").split("\n")]
        missing += [(entry["file"], entry["line"])] * (entry["line"] not in lines)
    for entry in settings["slip"]:
        count = (CHECKOUT / entry["file"]).read_text("utf-8").count(entry["line"])
        missing += [(entry["file"], entry["line"])] * (count != 1)
    assert not missing
