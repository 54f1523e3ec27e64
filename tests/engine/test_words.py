"""One word, one thing: no class or type of one name, or of its plural, means two things."""

import ast
from collections import defaultdict

from tests.engine.source_trees import ROOT, modules_of, text_of, tree_of

PACKAGES = ("pe_core", "pe_tools", "blender_addon", "benchmarks")


def is_name_of_type(target):
    """Whether a name is written as types are: not a constant, which has capitals alone."""
    return isinstance(target, ast.Name) and target.id[:1].isupper() and not target.id.isupper()


def types_of(tree):
    """(name, what it is) of the classes of a module, and of the types that it names."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            yield node.name.lstrip("_"), node
        elif isinstance(node, ast.Assign) and is_name_of_type(node.targets[0]):
            if getattr(node.value, "attr", None) == node.targets[0].id:
                continue  # another room's type, taken by its own name
            yield node.targets[0].id, ast.unparse(node.value)


def several_meanings(trees):
    """Names by their singular that stand for more than one thing, and the files they are in.

    The same type may be named in many files; a class is another thing wherever it is.
    """
    meanings = defaultdict(set)
    places = defaultdict(list)
    for place, tree in trees:
        for name, meaning in types_of(tree):
            meanings[name.removesuffix("s")].add((name, meaning))
            places[name.removesuffix("s")].append(f"{place}: {name}")
    return {word: places[word] for word, found in meanings.items() if len(found) > 1}


def test_every_type_has_a_word_of_its_own():
    files = [path for package in PACKAGES for path in modules_of(ROOT / package)]
    assert len(files) > 100
    assert several_meanings((p.relative_to(ROOT), tree_of(p)) for p in files) == {}


def test_what_builds_an_object_is_the_only_thing_called_of():
    """`of` is a class method that returns its own class, or None, wherever there is one."""
    for package in PACKAGES:
        for path in modules_of(ROOT / package):
            if "def of(" not in text_of(path):
                continue
            nodes = list(ast.walk(tree_of(path)))
            classes = [node for node in nodes if isinstance(node, ast.ClassDef)]
            builders = {id(f): c for c in classes for f in c.body if isinstance(f, ast.FunctionDef)}
            for node in nodes:
                if isinstance(node, ast.FunctionDef) and node.name == "of":
                    owner = builders.get(id(node))
                    assert owner is not None, path
                    assert [ast.unparse(d) for d in node.decorator_list] == ["classmethod"], path
                    returned = ast.unparse(node.returns).strip("'\"").removesuffix(" | None")
                    assert returned == owner.name, path
