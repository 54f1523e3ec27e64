"""A session over a pipe to a real Blender: it begins with the open scene, and each line of standard
output answers a request."""

import json

import pytest

import pe_core
import pe_tools as pt
from tests.blender.runner import output_of
from tests.engine import shapes
from tests.engine.processes import pe
from tests.engine.test_docs_examples import STUDY

POSE = {"position": [0.25, -0.1, 1.875], "rotation": [0, 3.5, -90]}
MODEL = "Hesai Pandar64"


@pytest.mark.thorough
def test_requests_over_a_pipe_are_answered_line_by_line(installed, sedan, tmp_path):
    """The scene's sensors, and a small study that is loaded; its score is that of `pe`."""
    body = shapes.box_car()
    pt.write_mesh(tmp_path / "box.npz", pe_core.Mesh(body.triangles, body.parts, body.part_names))
    study = tmp_path / "study.toml"
    study.write_text(STUDY, "utf-8")
    requests = [
        {"do": "set", "changes": {"samples": 4096}},
        {"do": "export", "to": "line"},
        {"do": "load", "study": str(study)},
        {"do": "set", "changes": {"sensor.roof.model": MODEL}},
        {"do": "score"},
        {"do": "move", "sensor": "roof", **POSE},
        {"do": "score"},
        {"do": "where", "model": "Velodyne VLP-16 Puck", "places": 10},
        {"do": "region", "sensor": "tail"},
    ]
    lines = "".join(f"{json.dumps({'id': k, **each})}\n" for k, each in enumerate(requests))
    answer = installed.pe(sedan, ["serve"], given=lines)
    assert answer.returncode == 0, output_of(answer)
    replies = [json.loads(line) for line in answer.stdout.splitlines() if line.startswith("{")]
    assert [each["id"] for each in replies] == list(range(len(requests))), output_of(answer)
    assert [each["status"] for each in replies] == [0] * 8 + [1], output_of(answer)
    scene, line, _, _, before, moved, after, places, refused = replies
    assert "roof_lidar" in scene["answer"]["sensors"]
    assert all(name in line["answer"]["line"] for name in scene["answer"]["sensors"])
    assert moved["answer"]["sensors"]["roof"] == POSE
    typed = [f"--set=sensor.roof.{key}={value}" for key, value in POSE.items()]
    alone = json.loads(
        pe(["score", study, *typed, f"--set=sensor.roof.model={MODEL}", "--json"]).stdout
    )
    assert before["answer"]["after"] != after["answer"]["after"] == alone["after"]
    assert len(places["answer"]["places"]) == 10
    assert refused["error"]["field"] == "sensor"
