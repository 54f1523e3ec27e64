"""What the pages show can be typed: lines of the command parse, and the Python of a page runs."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

import pe_core as pe
from pe_tools.cli.verbs import parser

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
BLOCK = re.compile(r"^ *```(\w*)\n(.*?)^ *```", re.MULTILINE | re.DOTALL)
STUDY = """\
samples = 1024
[space]
x = [-14, 14]
y = [-12, 12]
z = [0, 2]
interval = 0.5
[vehicle]
mesh = "box.npz"
[[sensor]]
name = "roof"
model = "Pandar64"
position = [0.0, 0.0, 1.8]
[[requirement]]
name = "child behind"
body = "child"
zone = { x = ["rear + 1", "rear + 2"], y = [-1, 1] }
[optimize]
samples = 1024
evaluations = 8
"""


def command_lines():
    """(page, line) of each complete line of the command that a page shows."""
    for page in [*sorted(DOCS.rglob("*.md")), ROOT / "README.md"]:
        for language, text in BLOCK.findall(page.read_text("utf-8")):
            if language not in ("", "sh", "console"):
                continue
            for line in text.splitlines():
                typed = line.removeprefix("$ ").partition("  #")[0].strip()
                if typed.startswith("pe ") and "..." not in typed and "$(" not in typed:
                    yield page.relative_to(ROOT).as_posix(), typed


LINES = sorted(set(command_lines()))


def test_lines_of_the_command_parse():
    assert len(LINES) > 60
    command = parser()
    for page, line in LINES:
        words = shlex.split(re.split(r" (?:>|\||&&|;) ?", line)[0])[1:]
        if words[0].startswith(("VERB", "-", "fit", "front", "review")):
            continue  # of plugins, or the help
        try:
            command.parse_args(words)
        except SystemExit as end:
            pytest.fail(f"{page}: {line}: {end}")


def test_the_python_of_the_page_runs(tmp_path, monkeypatch, capsys):
    page = (DOCS / "python.md").read_text("utf-8")
    blocks = [text for language, text in BLOCK.findall(page) if language == "python"]
    assert len(blocks) == 4
    corners = [(-2, -0.9, 0.2), (2, -0.9, 0.2), (2, 0.9, 0.2), (-2, 0.9, 1.5), (2, 0.9, 1.5)]
    faces = [[corners[k] for k in (0, 1, 4)], [corners[k] for k in (0, 2, 3)]]
    monkeypatch.chdir(tmp_path)
    pe.write_mesh(tmp_path / "box.npz", pe.Mesh(np.array(faces, float), np.zeros(2, int), ("box",)))
    (tmp_path / "study.toml").write_text(STUDY, "utf-8")
    names = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    said = capsys.readouterr().out
    assert "roof" in said and "met" in said
    assert (tmp_path / "results" / "result.json").is_file()
    assert pe.load_study(tmp_path / "small.toml").samples == 4096
