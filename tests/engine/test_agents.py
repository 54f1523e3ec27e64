"""What AGENTS.md shows can be typed, and llms.txt names the pages that there are."""

import io
import json
import re
import shlex
import sys
from types import SimpleNamespace

import pytest

from tests.engine.processes import pe
from tests.engine.test_docs import ROOT
from tests.engine.test_docs_examples import SMALL, files_of_a_reader

sys.path.insert(0, str(ROOT / "tools"))
import llms

AGENTS = (ROOT / "AGENTS.md").read_text("utf-8")
NOT_MET = 3


def block(language):
    """The lines of the page's only block of a language."""
    (text,) = re.findall(rf"(?ms)^```{language}\n(.*?)^```", AGENTS)
    return text.splitlines()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("agent")
    files_of_a_reader(made, "")
    (made / "study.toml").unlink()
    return made


def test_five_calls_score_search_check_and_export(folder, monkeypatch):
    """Each in the folder of the one before; the study is made small, to be quick."""
    monkeypatch.chdir(folder)
    calls = [shlex.split(line.partition("  #")[0]) for line in block("sh")]
    assert [call[1] for call in calls] == ["new", "score", "check", "optimize", "export"]
    for _, *call in calls:
        answer = pe(call)
        assert answer.returncode in (0, NOT_MET), answer.stderr
        data = json.loads(answer.stdout)
        if call[0] == "new":
            text = (folder / "study.toml").read_text("utf-8")
            text = re.sub(r"(?ms)^samples = .*?(?=^\[prior\])", SMALL, text, count=1)
            text = text.replace("evaluations = 0 ", "evaluations = 4 ")
            text = text.replace("samples = 65536 ", "samples = 1024 ")
            (folder / "study.toml").write_text(text)
        if call[0] == "score":
            assert {"entropy", "coverage", "warnings", "dashboard"} < data.keys()
            assert data["figures"]["after"]["values"] and data["after"]["stderr"] > 0.0
    assert (folder / "rig.urdf").is_file() and (folder / "results" / "result.json").is_file()


def test_every_request_of_the_session_is_answered(folder, monkeypatch):
    monkeypatch.chdir(folder)
    files_of_a_reader(folder, "")
    stdin = SimpleNamespace(buffer=io.BytesIO("\n".join(block("json")).encode()))
    monkeypatch.setattr(sys, "stdin", stdin)
    replies = [json.loads(line) for line in pe(["serve"]).stdout.splitlines()]
    assert [each["id"] for each in replies] == [1, 2, 3, 4, 5, 6, 7]
    assert [each.get("error") for each in replies] == [None] * len(replies)
    for reply in replies:
        assert f"`{reply['do']}`" in AGENTS


def test_llms_txt_is_what_its_tool_makes():
    """Its links lead to files of the checkout."""
    text = (ROOT / "llms.txt").read_text("utf-8")
    assert text == llms.text() and text.startswith("# ")
    links = re.findall(r"\]\(([^)]+)\)", text)
    assert len(links) > 40 and [link for link in links if not (ROOT / link).is_file()] == []
