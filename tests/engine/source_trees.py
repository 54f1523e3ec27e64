"""The project's sources as syntax trees: each file is read and parsed once for all tests."""

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]


@cache
def text_of(path: Path) -> str:
    """The text of a file."""
    return path.read_text("utf-8")


@cache
def tree_of(path: Path) -> ast.Module:
    """The syntax tree of a Python file; whoever asks changes nothing in it."""
    return ast.parse(text_of(path), str(path))


@cache
def modules_of(folder: Path) -> tuple[Path, ...]:
    """The Python files below a folder, in order."""
    return tuple(sorted(folder.rglob("*.py")))


@cache
def nodes_of(tree: ast.AST) -> tuple[ast.AST, ...]:
    """Every node of a syntax tree; walked once however many tests ask."""
    return tuple(ast.walk(tree))


def imported(path: Path, root: Path = ROOT):
    """Full dotted names of all that a file imports, inside functions too."""
    package = path.relative_to(root).parts[:-1]
    for node in nodes_of(tree_of(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            start = package[: len(package) - node.level + 1] if node.level else ()
            module = [*start, *(node.module.split(".") if node.module else [])]
            yield from (".".join([*module, alias.name]) for alias in node.names)
