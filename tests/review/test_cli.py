"""The verb, and the page beside a search's results, as a user runs them."""

import dataclasses
import html
import json
import re
import shlex
import shutil
import tomllib

import pytest

import pe_tools as pt
from pe_tools import jobs
from pe_tools.cli.verbs import main
from pe_tools.page import PAGE
from pe_tools.page.build import outcome_of_folder
from pe_tools.page.markup import escaped
from pe_tools.page.sections import SECTIONS
from tests.review.conftest import outcome_of, small_study

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


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The folder of a search that left no page."""
    folder = tmp_path_factory.mktemp("search")
    pt.export_study(small_study(), folder / "study.toml")
    out = folder / "out"
    options = ["-o", str(out), "--no-review", "--evaluations", "20"]
    assert main(["optimize", str(folder / "study.toml"), *options]) == 0
    assert not (out / PAGE).exists()
    return out


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


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("evaluations", "NaN", "NaN, which is no JSON"),
        ("entropy", "-Infinity", "-Infinity, which is no JSON"),
        ("evaluations", "1e999", "1e999, which is too large"),
        ("seed", '"\\ud800"', "half a surrogate pair"),
        ("run", "null", None),
        ("run", "[1]", None),
        ("history", "3", "the result of a search"),
        ("warnings", "null", "the result of a search"),
    ],
)
def test_a_result_that_is_none_is_one_line(found, tmp_path, capsys, key, value, message):
    out = shutil.copytree(found, tmp_path / "out")
    path = out / "result.json"
    data = json.loads(path.read_text("utf-8")) | {key: "HERE"}
    path.write_text(json.dumps(data).replace('"HERE"', value))
    capsys.readouterr()
    assert main(["review", str(out), "-o", str(tmp_path / "page")]) == (message is not None)
    if message is not None:
        assert message in capsys.readouterr().err.splitlines()[-1]


def test_a_search_leaves_its_page(study, tmp_path, capsys):
    out = tmp_path / "out a"
    assert main(["optimize", str(study), "-o", str(out)]) == 0
    text = (out / PAGE).read_text("utf-8")
    assert "Moves of the sensors" in text
    told = shlex.join(["pe", "optimize", str(study), "-o", str(out)])
    assert f"<pre>{escaped(told)}</pre>" in text
    given = html.unescape(re.search(r'<pre id="study-a"[^>]*>(.*?)</pre>', text, re.S)[1])
    assert tomllib.loads(given)["sensor"] == tomllib.loads(study.read_text("utf-8"))["sensor"]
    assert jobs.files_of_other_runs(out) == []
    assert main(["score", str(study), "-o", str(out)]) == 0
    assert not (out / PAGE).exists(), "it told of the search"


def test_a_folder_of_results_is_reviewed_as_the_search_it_was(study, tmp_path, capsys):
    out, held = (
        tmp_path / "out",
        '[[requirement]]\nname = "child"\npreset = "ncap26_forward_child"\n',
    )
    study.write_text(f"{study.read_text('utf-8')}\n{held}", "utf-8")
    assert main(["optimize", str(study), "-o", str(out)]) == 0
    told = json.loads((out / "result.json").read_text("utf-8"))["requirements"]
    again = outcome_of_folder(out, lambda each: outcome_of(pt.ScoreJob(each)))
    assert json.loads(json.dumps([v.to_dict() for v in again.verdicts])) == told != []
    left = (out / PAGE).read_text("utf-8").replace("a &lt;b&gt; &amp; c.npz", "vehicle.npz")
    assert main(["review", str(out), "-o", str(tmp_path / "again")]) == 0
    assert (tmp_path / "again" / PAGE).read_text("utf-8") == left
    (out / "result.json").write_text("{}")
    assert main(["review", str(out), "-o", str(tmp_path / "again")]) == 1
    assert "result.json: file: expected the result of a search" in capsys.readouterr().err
