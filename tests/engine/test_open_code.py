"""Code is open: one name a value, arguments in the call, constants above what uses them."""

import ast
import builtins

import pytest

from tests.engine.source_trees import ROOT, modules_of, nodes_of, tree_of

FOLDERS = ("pe_core", "pe_tools", "blender_addon", "studies", "tools", "benchmarks", "tests")
MAX_POSITIONAL = 4


@pytest.fixture(params=FOLDERS)
def trees(request):
    """Syntax trees of a folder's own files, by their path from the checkout."""
    return {
        path.relative_to(ROOT).as_posix(): tree_of(path)
        for path in modules_of(ROOT / request.param)
        if "_vendor" not in path.parts
    }


def names_in(node, context=ast.Load):
    """The names that stand in a node, to be read or to be written."""
    return {n.id for n in nodes_of(node) if isinstance(n, ast.Name) and isinstance(n.ctx, context)}


def places(trees, is_closed):
    """Where a file has a node of which something is true."""
    return [
        f"{name}:{node.lineno}: {ast.unparse(node)[:90]}"
        for name, tree in trees.items()
        for node in nodes_of(tree)
        if is_closed(node)
    ]


def is_pair_of_assignments(node):
    """`a, b = x, y`, where no value reads what is written: a swap does."""
    if not (isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple)):
        return False
    if len(node.targets) > 1 or not isinstance(node.targets[0], ast.Tuple):
        return False
    if any(isinstance(each, ast.Starred) for each in node.value.elts):
        return False
    written = {n.id for n in ast.walk(node.targets[0]) if isinstance(n, ast.Name)}
    return not written & names_in(node.value)


def is_splat_of_a_literal(node):
    """`f(*(a, b))`, and the same in a tuple, a list or a set."""
    return isinstance(node, ast.Starred) and isinstance(node.value, ast.Tuple | ast.List)


def is_blind_construction(node):
    """`Score(a, b, c, d, e)`: a class is made of more values than a reader can count."""
    if not isinstance(node, ast.Call) or any(isinstance(each, ast.Starred) for each in node.args):
        return False
    name = ast.unparse(node.func).rpartition(".")[2]
    is_class = name[:1].isupper() and not name.isupper() and name.isidentifier()
    return is_class and len(node.args) > MAX_POSITIONAL


def late_constants(tree):
    """Constants below a module's first definition that could stand above it."""
    known = set(dir(builtins)) | {"__file__", "__name__", "__package__"}
    stored = [n.id for n in nodes_of(tree) if isinstance(n, ast.Name) and is_store(n)]
    is_below = False
    for node in tree.body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            is_below = True
            continue
        written = {n.id for n in ast.walk(node) if isinstance(n, ast.Name) and is_store(n)}
        if not is_below:
            known |= written
            known |= {(a.asname or a.name).split(".")[0] for a in aliases(node)}
        elif isinstance(node, ast.Assign | ast.AnnAssign) and node.value is not None:
            inner = {n.id for n in ast.walk(node.value) if isinstance(n, ast.Name) and is_store(n)}
            inner |= {n.arg for n in ast.walk(node.value) if isinstance(n, ast.arg)}
            names = written - inner
            is_constant = names and all(n.isupper() and stored.count(n) == 1 for n in names)
            if is_constant and names_in(node) - inner <= known:
                yield node.lineno


def is_store(name):
    """Whether a name is written."""
    return isinstance(name.ctx, ast.Store)


def aliases(node):
    """What a statement imports."""
    return [each for each in ast.walk(node) if isinstance(each, ast.alias)]


@pytest.mark.parametrize("is_closed", [is_pair_of_assignments, is_splat_of_a_literal])
def test_a_line_says_one_thing(trees, is_closed):
    assert not places(trees, is_closed)


def test_who_makes_an_object_names_its_values(trees):
    ours = {name: tree for name, tree in trees.items() if not name.startswith("tests/")}
    assert not places(ours, is_blind_construction)


def test_constants_stand_above_the_first_definition(trees):
    late = {name: list(late_constants(tree)) for name, tree in trees.items()}
    assert not {name: lines for name, lines in late.items() if lines}


@pytest.mark.parametrize(
    ("code", "is_closed"),
    [
        ("a, b = 1, 2", is_pair_of_assignments),
        ("f(*(a, b))", is_splat_of_a_literal),
        ("Score(1, 2, 3, 4, 5)", is_blind_construction),
    ],
)
def test_what_is_looked_for_is_found(code, is_closed):
    assert places({"a.py": ast.parse(code)}, is_closed)
    assert not places(
        {"a.py": ast.parse("a, b = b, a; f(*c, e=1); Score(1, 2, 3, 4, e=5)")}, is_closed
    )


def test_a_late_constant_is_found():
    assert list(late_constants(ast.parse("def f(): ...\nA = 1\nB = f()"))) == [2]
