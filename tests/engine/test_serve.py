"""A session over a pipe: a line answers a line, errors end nothing, and bits are those of `pe`."""

import io
import json
import sys
from types import SimpleNamespace

import pytest

import pe_core
import pe_tools as pt
from pe_tools.cli import verbs
from pe_tools.cli.serve_verb import MAX_LINE_BYTES
from tests.engine import shapes
from tests.engine.processes import pe
from tests.engine.test_docs_examples import STUDY

POSE = {"position": [0.25, -0.1, 1.875], "rotation": [0, 3.5, -90]}
WRONG = [
    b"no json",
    b'"text"',
    b"\xff\xfe",
    b"[" * 100_000,
    b'{"do": "score", "x": NaN}',
    b'{"do": "' + b"x" * MAX_LINE_BYTES + b'"}',
    {},
    {"do": 3},
    {"do": "fly"},
    {"do": "optimize"},
    {"do": "load"},
    {"do": "load", "study": "none.toml"},
    {"do": "load", "study": "box.npz"},
    {"do": "load", "study": "study.toml", "set": {"samples": "many"}},
    {"do": "move", "sensor": "tail", "position": [0, 0, 1]},
    {"do": "move", "sensor": "roof"},
    {"do": "move", "sensor": "roof", "position": [0, 0]},
    {"do": "move", "sensor": "roof", "position": None},
    {"do": "set", "changes": {"sensor.roof.modle": 3}},
    {"do": "set", "changes": ["samples=1"]},
    {"do": "score", "sample": 4},
    {"do": "score", "json": False},
    {"do": "explain", "at": ["--help"]},
    {"do": "explain", "at": [1]},
    {"do": "explain", "suggest": 1},
    {"do": "explain", "at": [[1], 2]},
    {"do": "where"},
    {"do": "where", "model": "none"},
    {"do": "export"},
    {"do": "region"},
    {"do": "region", "sensor": "tail"},
    {"do": "region", "sensor": "--help"},
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("served")
    body = shapes.box_car()
    pt.write_mesh(made / "box.npz", pe_core.Mesh(body.triangles, body.parts, body.part_names))
    (made / "study.toml").write_text(STUDY, "utf-8")
    return made


@pytest.fixture
def served(folder, monkeypatch):
    """The replies to requests, in a session of this process that ends with its input."""
    monkeypatch.chdir(folder)

    def replies(*requests):
        lines = [
            each if isinstance(each, bytes) else json.dumps(each).encode() for each in requests
        ]
        stdin = SimpleNamespace(buffer=io.BytesIO(b"\n".join(lines)))
        monkeypatch.setattr(sys, "stdin", stdin)
        answer = pe(["serve"])
        assert answer.returncode == 0 and answer.stderr == ""
        return [json.loads(line) for line in answer.stdout.splitlines()]

    return replies


def without_run(data):
    return {key: value for key, value in data.items() if key != "run"}


def test_bits_are_those_of_the_command(served):
    """A moved sensor, and keys that are set, as if they stood on the command line. A session keeps
    what evaluates its study while only the rig changes: it has scored before."""
    others = {"prior.model": "highway", 'requirement."child behind".body': ["adult"]}
    loaded, first, moved, _, scored, asked, _, last = replies = served(
        {"id": "a", "do": "load", "study": "study.toml"},
        {"do": "score"},
        {"do": "move", "sensor": "roof", **POSE},
        {"do": "set", "changes": {"sensor.roof.model": "Hesai Pandar64"}},
        {"do": "score"},
        {"id": 7, "do": "explain", "at": [8, -0.00001]},
        {"do": "set", "changes": others},
        {"do": "score"},
    )
    assert [each["status"] for each in replies] == [0] * len(replies)
    assert (loaded["id"], moved["id"], asked["id"]) == ("a", None, 7)
    assert moved["answer"]["sensors"]["roof"] == POSE
    assert loaded["answer"]["vehicle"] == moved["answer"]["vehicle"] is not None
    typed = [f"--set=sensor.roof.{key}={value}" for key, value in POSE.items()]
    typed.append("--set=sensor.roof.model=Hesai Pandar64")
    changed = [*typed, *(f"--set={key}={value}" for key, value in others.items())]
    before = first["answer"]["after"]
    for own, options in ((scored["answer"], typed), (last["answer"], changed)):
        alone = json.loads(pe(["score", "study.toml", *options, "--json"]).stdout)
        assert own["after"] == alone["after"] != before
        assert own["figures"] == alone["figures"]
        assert own["requirements"] == alone["requirements"]
        assert without_run(own).keys() == without_run(alone).keys()
        before = own["after"]
    place = json.loads(
        pe(["explain", "study.toml", *typed, "--at", "8", "-0.00001", "--json"]).stdout
    )
    assert asked["answer"] == place


def test_a_bad_line_is_one_error_and_the_session_goes_on(served):
    first, *wrong, last = served(
        {"do": "load", "study": "study.toml"}, *WRONG, {"id": 1, "do": "export", "to": "line"}
    )
    assert len(wrong) == len(WRONG) and first["status"] == 0
    for given, reply in zip(WRONG, wrong, strict=True):
        assert reply["status"] in (1, 2) and "answer" not in reply, given
        text = reply["error"]["text"]
        assert text and "\n" not in text and "command line" not in text, given
    assert last["status"] == 0 and last["id"] == 1
    assert last["answer"]["line"].count("roof") == 1  # nothing was changed


def test_a_session_begins_without_a_study(served):
    (reply,) = served({"do": "score"})
    assert reply["status"] == 1 and reply["error"]["field"] == "study"
    assert served() == []


def test_replies_are_as_their_schema_says(served):
    jsonschema = pytest.importorskip("jsonschema", reason="of the extra test")
    schema = json.loads(pe(["serve", "--help", "--json"]).stdout)["answers"]
    for reply in served({"do": "load", "study": "study.toml"}, {"do": "fly"}):
        jsonschema.validate({"serve": reply}, schema)


def test_a_session_ends_where_nobody_reads(folder, monkeypatch):
    class Gone(io.StringIO):
        def write(self, _text):
            raise BrokenPipeError("nobody")

        def fileno(self):
            raise OSError

    stdin = SimpleNamespace(buffer=io.BytesIO(b'{"do": "fly"}\n' * 3))
    monkeypatch.setattr(sys, "stdin", stdin)
    monkeypatch.setattr(sys, "stdout", Gone())
    assert verbs.main(["serve"]) == 1
