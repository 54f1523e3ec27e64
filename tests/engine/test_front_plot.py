"""The plot of a front: drawn from front.json, again and again the same."""

import json
import math

import pytest

from pe_tools.plots import plotting
from tests.engine.processes import pe

ROWS = [
    {"name": "small", "on_front": True, "price": 1.0, "entropy": 9.0},
    {"name": "poor", "on_front": False, "price": 3.0, "entropy": 8.5},
    {"name": "large $ <b>", "on_front": True, "price": 2.0, "entropy": 8.0},
]


@pytest.fixture
def folder(tmp_path):
    data = {"currency": "EUR", "designs": ROWS}
    (tmp_path / "front.json").write_text(json.dumps(data))
    return tmp_path


def test_the_verb_draws_the_plot(folder):
    run = pe("front", folder)
    assert (run.returncode, run.stderr) == (0, "")
    assert run.stdout.strip() == str(folder / "front.png")
    assert (folder / "front.png").read_bytes().startswith(b"\x89PNG")


def test_designs_of_the_front_are_numbered_and_named(monkeypatch, tmp_path):
    figures = []
    monkeypatch.setattr(plotting, "save_plot", lambda figure, _path: figures.append(figure))
    plotting.draw_front(tmp_path / "front.png", {"currency": "EUR", "designs": ROWS})
    plot, key = figures[0].axes
    places = {text.get_text(): text.get_position() for text in plot.texts}
    assert places == {"1": (1.0, 9.0), "2": (2.0, 8.0)}
    assert [text.get_text() for text in key.texts] == ["1", "small", "2", "large $ <b>"]
    assert plot.get_xlabel() == "price [EUR]"


NO_FRONT = "the front that `pe optimize` wrote"
OF_NAN = json.dumps({"currency": "", "designs": [ROWS[0] | {"entropy": math.nan}]})


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("{}", NO_FRONT),
        ('{"currency": "", "designs": []}', NO_FRONT),
        ('{"designs": 3}', NO_FRONT),
        ("[", "valid JSON"),
        (OF_NAN, "valid JSON, found NaN"),
    ],
)
def test_another_file_is_refused_in_one_line(folder, text, expected):
    (folder / "front.json").write_text(text)
    run = pe("front", folder)
    assert run.returncode == 1
    assert run.stderr.count("\n") == 1
    assert f"front.json: file: expected {expected}" in run.stderr
