"""docs/python.md as a notebook: its cells are run in order, and show what they give.

Cells are the blocks ``python`` of the page. In the file, a block ``text`` behind a cell has what
it prints, and the value of its last line; an image is the plot that it made. ``python -m
docs_site.notebook``, in tools/, writes these again. The site shows values as tables where they have
one, and offers the page as a notebook of Jupyter.
"""

from __future__ import annotations

import ast
import contextlib
import functools
import io
import json
import os
import re
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parents[2]
PAGE = "python.md"
NOTEBOOK = "python.ipynb"
CELL = re.compile(
    r"```python\n(?P<code>.*?)```\n"
    r"(?:\n```text\n(?P<text>.*?)```\n)?(?:\n!\[(?P<alt>[^]]*)\]\((?P<image>images/\S+?)\)\n)?",
    re.DOTALL,
)
DPI = 80


class Shown(NamedTuple):
    """What a cell gives: its text, the same as HTML, and its plot as PNG."""

    text: str
    html: str
    png: bytes


def cells_of(page: str) -> list[str]:
    """Return the code of each cell."""
    return [match["code"] for match in CELL.finditer(page)]


def run(cells: Sequence[str]) -> list[Shown]:
    """Run cells in one namespace and a folder of their own, which has examples/ of the checkout."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    names: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        os.symlink(ROOT / "examples", "examples")
        found = [shown(cell, names, plt) for cell in cells]
    return found


def shown(cell: str, names: dict[str, Any], plt: Any) -> Shown:
    """Run a cell; take what it printed, the value of its last line, and its plot."""
    tree = ast.parse(cell)
    printed = io.StringIO()
    value = None
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, PAGE, "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), PAGE, "eval"), names)
    png = b""
    if plt.get_fignums():
        picture = io.BytesIO()
        plt.gcf().savefig(picture, dpi=DPI, metadata={"Software": None})
        plt.close("all")
        png = picture.getvalue()
        value = None
    said = printed.getvalue()
    html = value._repr_html_() if hasattr(value, "_repr_html_") else ""
    html = html.replace(' border="1" class="dataframe"', "")  # of pandas; the site has its own
    return Shown(said + ("" if value is None else f"{value!r}\n"), html, png)


def refreshed(page: str, found: Sequence[Shown]) -> str:
    """Return the page with what its cells give now; an image keeps its name and its text."""
    results = iter(found)

    def with_result(match: re.Match[str]) -> str:
        own = next(results)
        text = f"\n```text\n{own.text}```\n" if own.text else ""
        image = f"\n![{match['alt']}]({match['image']})\n" if own.png else ""
        return f"```python\n{match['code']}```\n{text}{image}"

    return CELL.sub(with_result, page)


@functools.cache
def page_run() -> tuple[Shown, ...]:
    """Return what the cells of the page give; an error of a cell ends the build."""
    return tuple(run(cells_of((ROOT / "docs" / PAGE).read_text("utf-8"))))


def on_site(page: str) -> str:
    """Return the page with tables in place of lines, and a link to the notebook."""
    results = iter(page_run())

    def with_table(match: re.Match[str]) -> str:
        own = next(results)
        if not own.html:
            return match[0]
        return f'```python\n{match["code"]}```\n\n<div class="output">{own.html}</div>\n'

    told = f"This page was run when the site was built. As a notebook: [{NOTEBOOK}]({NOTEBOOK})."
    head, _, rest = CELL.sub(with_table, page).partition("\n\n")
    return f"{head}\n\n{told}\n\n{rest}"


def notebook() -> str:
    """Return the page as a notebook of Jupyter: its text, its cells, without what they give."""
    page = (ROOT / "docs" / PAGE).read_text("utf-8")
    place = 0
    cells = []
    for match in CELL.finditer(page):
        cells += [("markdown", page[place : match.start()]), ("code", match["code"])]
        place = match.end()
    cells.append(("markdown", page[place:]))
    code = {"execution_count": None, "outputs": []}
    rows = [
        {"cell_type": kind, "metadata": {}, "source": text.strip(), "id": f"cell-{number}"}
        | (code if kind == "code" else {})
        for number, (kind, text) in enumerate(cells)
        if text.strip()
    ]
    data = {"cells": rows, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(data, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    path = ROOT / "docs" / PAGE
    text = path.read_text("utf-8")
    found = page_run()
    for match, own in zip(CELL.finditer(text), found, strict=True):
        if own.png:
            (path.parent / match["image"]).write_bytes(own.png)
    path.write_text(refreshed(text, found), "utf-8")
