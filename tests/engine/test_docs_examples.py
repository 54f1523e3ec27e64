"""What the pages show can be typed: lines of the command parse, and the Python of a page runs."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

import pe_core as pe
import pe_tools as pt
from pe_tools.cli.verbs import parser
from tests.engine import shapes
from tests.engine.mesh_files import stl_binary, to_gltf
from tests.thorough import THOROUGH

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
model = "Velodyne VLP-16 Puck"
position = [0.0, 0.0, 1.8]
[[requirement]]
name = "child behind"
body = ["child"]
zone = { x = ["rear + 1", "rear + 2"], y = [-1, 1] }
[optimize]
samples = 1024
evaluations = 8
"""
HOW_TO = sorted(p.relative_to(ROOT).as_posix() for p in DOCS.glob("howto/*.md"))
TYPED = ["README.md", *(HOW_TO if THOROUGH else [])]
"""Pages whose commands a newcomer types from the first to the last."""
SMALL = "samples = 1024\n\n[space]\nx = [-14, 14]\ny = [-12, 12]\nz = [0, 2]\ninterval = 0.5\n\n"
CHOICE = """
[[selection.choice]]
sensors = ["roof"]
option = [
    { model = "Velodyne VLP-16 Puck", price = 100 },
    { model = "Hesai Pandar64", price = 600 },
]
"""
FIRST = ["pe optimize car.toml -o results", "pe new car.glb -o start.toml"]
"""What a reader has done before, in Blender and on the command line."""
OF_THEIR_OWN = ("README.md", "docs/howto/choose_sensors.md", "docs/howto/vehicle.md")
"""Pages that begin with another study or with none, or that show what a whole one prints."""
NOT_MET = 3
TYPE_ALL = r"""
import contextlib, importlib, io, json, os, re, shlex, shutil, sys, traceback
from dataclasses import replace
from pathlib import Path
from pe_core.scoring.sight import sight
from pe_core.study import suggestion
from pe_tools.__main__ import main
from pe_tools.jobs import where_job
from pe_tools.page.pictures import sensor_views, vehicle_picture
small, pages = json.load(sys.stdin)
robustness = importlib.import_module("pe_core.search.tolerance")
robustness.WORKSHOP = replace(robustness.WORKSHOP, draws=2)
vehicle_picture.SIZE, sensor_views.MAX_WIDTH = (192, 108), 128
objects = sight.ObjectEvaluator
of_few = lambda *where, targets, **more: objects(*where, targets=replace(targets, scenes=4), **more)
os.cpu_count = lambda: 1  # no worker processes: their starts would take most of the time
for page, (folder, lines) in pages.items():
    if page != "README.md":  # which shows what is printed
        sight.ObjectEvaluator = of_few
        sight.SECTOR_HEIGHTS_M, sight.SAMPLES = (0.5,), 4096
        suggestion.HELP_PLACES, suggestion.ADD_PLACES, suggestion.ADD_COMPARED = 8, 16, 2
        where_job.COMPARED = 2
    os.chdir(folder)
    for made in ("sweep", "review", "cad"):
        shutil.rmtree(made, ignore_errors=True)
    for line in lines:
        out, err, words = io.StringIO(), io.StringIO(), shlex.split(line)[1:]
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            try:
                sys.argv = ["pe", *words]
                status = main()
            except SystemExit as end:
                status = end.code
            except BaseException:
                status = traceback.format_exc()
        answer = [page, line, status, out.getvalue()[:2000], err.getvalue()[-2000:]]
        print(json.dumps(answer), file=sys.__stdout__)
        if words[0] == "new" and not status:  # a newcomer's study is made small, to be quick
            study = Path(words[words.index("-o") + 1])
            text = re.sub(r"(?ms)^samples = .*?(?=^\[prior\])", small, study.read_text(), count=1)
            study.write_text(text.replace("evaluations = 0 ", "evaluations = 4 "))
"""
"""Types the lines of all pages into a Python without extras, in one process."""


def command_lines():
    """(page, line) of each complete line of the command that a page shows."""
    for page in [*sorted(DOCS.rglob("*.md")), ROOT / "README.md"]:
        for language, text in BLOCK.findall(page.read_text("utf-8")):
            if language not in ("", "sh", "console"):
                continue
            for line in text.splitlines():
                typed = line.removeprefix("$ ").partition("  #")[0].strip()
                typed = typed.replace("$SLURM_ARRAY_TASK_ID", "1")  # of a job's script
                if typed.startswith("pe ") and "..." not in typed and "$(" not in typed:
                    yield page.relative_to(ROOT).as_posix(), typed


LINES = sorted(set(command_lines()))


def test_lines_of_the_command_parse():
    assert len(LINES) > 60
    command = parser()
    for page, line in LINES:
        words = shlex.split(re.split(r" (?:>|\||&&|;) ?", line)[0])[1:]
        if words[0].startswith(("VERB", "-")):
            continue  # the help
        try:
            command.parse_args(words)
        except SystemExit as end:
            pytest.fail(f"{page}: {line}: {end}")


@pytest.fixture(scope="module")
def bare_python(tmp_path_factory):
    """A Python that has this checkout and what it depends on, and no extra."""
    folder = tmp_path_factory.mktemp("bare")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    packages = next((folder / "lib").glob("python*/site-packages"))
    for name in ("numpy", "numpy.libs", "ruamel", "trimesh"):
        if (installed := Path(np.__file__).parents[1] / name).exists():
            (packages / name).symlink_to(installed)
    (packages / "checkout.pth").write_text(f"{ROOT}\n")
    return folder / "bin" / "python"


def files_of_a_reader(folder, page):
    """Write what the reader of a page has: a car in three formats, studies, a detector's table."""
    body = shapes.box_car()
    wheels = [shapes.box((x, -0.9, 0.0), (x + 0.6, 0.9, 0.3)) for x in (-1.6, 1.1)]
    names = ("wheel_rear", "wheel_front")
    sizes = [len(wheel) for wheel in wheels]
    car = pe.Mesh(
        np.concatenate([body.triangles, *wheels]),
        np.concatenate([body.parts, np.repeat([2, 3], sizes)]).astype(int),
        (*body.part_names, *names),
    )
    points = car.triangles.reshape(-1, 3)
    faces = np.arange(len(points)).reshape(-1, 3)
    trimesh.Trimesh(to_gltf(points), faces).export(folder / "car.glb")
    (folder / "car.stl").write_bytes(stl_binary(triangles=1000.0 * to_gltf(car.triangles)))
    for name in ("robotaxi_sedan", "crossing_child"):
        if not (made := folder / "examples" / name).exists():
            shutil.copytree(ROOT / "examples" / name, made)
            for path in [] if page == "README.md" else made.glob("*.toml"):
                text = re.sub(r"(?m)^samples = \d+", "samples = 1024", path.read_text("utf-8"))
                path.write_text(re.sub(r"(?m)^interval = 0.1", "interval = 0.5", text), "utf-8")
    pt.write_mesh(folder / "box.npz", car)
    study = STUDY + (CHOICE if "choose_sensors" in page else "")
    for name in ("study.toml", "car.toml"):
        (folder / name).write_text(study, "utf-8")


@pytest.fixture(scope="module")
def typed(bare_python, tmp_path_factory):
    """Answers to every line of the pages: page, line, status, stdout, stderr."""
    shared = tmp_path_factory.mktemp("typed")
    pages = {}
    own = {page: tmp_path_factory.mktemp("own") for page in OF_THEIR_OWN}
    shown = [each for each in command_lines() if each[0] in TYPED]
    told = [{*line.split()} for page, line in shown if page not in own]
    for page in TYPED:
        files_of_a_reader(own.get(page, shared), page)
        lines = [line for of, line in shown if of == page]
        if page not in own:  # the same with more options is typed elsewhere, and twice is slow
            whole = [line for line in lines if not any({*line.split()} < more for more in told)]
            typed_before = {line for _, before in pages.values() for line in before}
            lines = [line for line in whole if line not in typed_before]
        pages[page] = str(own.get(page, shared)), lines
    for first in [page for page in TYPED if page not in own][:1]:
        pages[first][1][:0] = FIRST
    (own["docs/howto/vehicle.md"] / "study.toml").unlink(missing_ok=True)
    run = subprocess.run(
        [bare_python, "-c", TYPE_ALL],
        input=json.dumps([SMALL, pages]),
        capture_output=True,
        text=True,
        cwd=tmp_path_factory.getbasetemp(),
    )
    assert run.returncode == 0, run.stderr
    return [json.loads(line) for line in run.stdout.splitlines()]


def test_commands_of_readme_and_how_to_pages_do_as_typed_without_extras(typed):
    assert {page for page, *_ in typed} == {*TYPED}
    wrong = []
    for page, line, status, _, said in typed:
        may_miss = line.startswith("pe check")
        as_expected = status == 0 or (status == NOT_MET and may_miss)
        wrong += [] if as_expected else [(page, line, said)]
    assert not wrong


def test_readme_shows_what_its_example_prints(typed):
    readme = (ROOT / "README.md").read_text("utf-8")
    (line,) = (line for page, line in LINES if page == "README.md")
    (printed,) = (
        out for page, typed_line, _, out, _ in typed if (page, typed_line) == ("README.md", line)
    )
    assert f"```\n{printed}```" in readme
