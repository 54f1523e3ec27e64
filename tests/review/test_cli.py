"""The verb, and the page beside a search's results, as a user runs them."""

import dataclasses
import shlex
import tomllib

import pytest

import pe_tools as pt
from pe_tools.cli.verbs import main
from pe_tools.page import PAGE
from pe_tools.page.markup import escaped
from pe_tools.page.sections import SECTIONS
from tests.review.conftest import small_study
from tests.review.dom import parsed

NAMED = "a <b> & c"
"""A file's name that a page must escape."""


@pytest.fixture(autouse=True)
def few_sections(monkeypatch):
    """What the page says is tested elsewhere."""
    kept = [each for each in SECTIONS if each.anchor in ("search", "again")]
    monkeypatch.setattr("pe_tools.page.document.SECTIONS", kept)


@pytest.fixture
def study(tmp_path):
    """A study file with its mesh, its name full of HTML and spaces."""
    path = tmp_path / f"{NAMED}.toml"
    pt.export_study(small_study(), path)
    return path


def test_a_study_s_page_is_written_and_its_path_printed(study, tmp_path, capsys):
    said = ["--title", "Roof", "--author", "A <b>", "--date", "May", "--revision", "3"]
    assert main(["review", str(study), "-o", str(tmp_path / "new" / "out"), *said]) == 0
    path = tmp_path / "new" / "out" / PAGE
    assert capsys.readouterr().out == f"{path}\n"
    text = path.read_text("utf-8")
    assert "a &lt;b&gt; &amp; c" in text and NAMED not in text
    assert "<h1>Roof</h1>" in text and "A &lt;b&gt;, May, Revision 3</p>" in text
    given = shlex.join(["pe", "review", str(study), "-o", str(path.parent), *said])
    assert f"<pre>{escaped(given)}</pre>" in text
    assert [each.name for each in path.parent.glob("*.html")] == [PAGE]


def test_ctrl_c_while_the_page_is_written_leaves_all_as_it_was(
    study, tmp_path, capsys, monkeypatch
):
    def interrupted(_):
        raise KeyboardInterrupt

    (tmp_path / PAGE).write_text("mine")
    before = sorted(path.name for path in tmp_path.iterdir())
    broken = dataclasses.replace(SECTIONS[-1], data=interrupted)
    monkeypatch.setattr("pe_tools.page.document.SECTIONS", (broken,))
    assert main(["review", str(study), "-o", str(tmp_path), "--replace"]) == 130
    assert sorted(path.name for path in tmp_path.iterdir()) == before
    assert (tmp_path / PAGE).read_text() == "mine"
    assert main(["review", str(study), "-o", str(tmp_path / "new")]) == 130
    assert not (tmp_path / "new" / PAGE).exists()
    assert "interrupted" in capsys.readouterr().err


def test_a_search_leaves_its_page(study, tmp_path, capsys):
    out = tmp_path / "out a"
    assert main(["optimize", str(study), "-o", str(out)]) == 0
    text = (out / PAGE).read_text("utf-8")
    assert "Moves of the sensors" in text
    told = shlex.join(["pe", "optimize", str(study), "-o", str(out)])
    assert f"<pre>{escaped(told)}</pre>" in text
    given = parsed(text).one("pre", id="study-a").text
    assert tomllib.loads(given)["sensor"] == tomllib.loads(study.read_text("utf-8"))["sensor"]
    assert main(["score", str(study), "-o", str(out)]) == 0
    assert not (out / PAGE).exists(), "it told of the search"
