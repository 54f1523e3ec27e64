"""docs/python.md gives what it shows; each public name has an example, and all of them hold."""

import doctest
import io
import json
import re
import sys

import pytest

import pe_core as pe
import pe_tools as pt
from tests.engine.test_docs import ROOT

sys.path.insert(0, str(ROOT / "tools"))
from docs_site import notebook, python_names

PAGE = (ROOT / "docs" / notebook.PAGE).read_text("utf-8")
PUBLIC = {f"pe.{name}" for name in pe.__all__} | {f"pt.{name}" for name in pt.__all__}
ALIKE = 0.01
OTHER = 0.02
"""Mean difference of two pictures, 0 to 1: of the same plot by another matplotlib; of another."""


@pytest.fixture(scope="module")
def found():
    return notebook.page_run()


@pytest.mark.thorough
def test_cells_give_what_the_page_shows(found):
    assert len(found) > 12
    assert notebook.refreshed(PAGE, found) == PAGE


def test_the_notebook_has_the_page_s_cells_in_order():
    cells = json.loads(notebook.notebook())["cells"]
    code = [cell["source"] for cell in cells if cell["cell_type"] == "code"]
    assert code == [cell.strip() for cell in notebook.cells_of(PAGE)]
    assert cells[0]["source"].startswith("# Starting in Python")


def test_each_public_name_has_an_example():
    assert set(python_names.examples()) == PUBLIC


def test_examples_of_public_names_hold(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = python_names.EXAMPLES.read_text("utf-8")
    blocks = re.findall(r"(?:^### (\S+)\n\n)?^```pycon\n(.*?)^```\n", text, re.M | re.S)
    assert len(blocks) == len(PUBLIC) + 1
    names = {}
    wrong = {}
    parser = doctest.DocTestParser()
    for name, block in blocks:
        runner = doctest.DocTestRunner(verbose=False)
        said = io.StringIO()
        test = parser.get_doctest(block, names, name or "first", str(python_names.EXAMPLES), 0)
        assert test.examples, name
        if runner.run(test, out=said.write, clear_globs=False).failed:
            wrong[name] = said.getvalue()
        names.update(test.globs)
    assert not wrong, "\n".join(wrong.values())


def test_a_package_shows_its_public_names_and_no_helpers():
    assert dir(pe) == sorted(pe.__all__) and dir(pt) == sorted(pt.__all__)
