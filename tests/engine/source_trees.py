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
