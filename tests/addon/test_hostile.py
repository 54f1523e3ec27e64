"""Whatever is typed into the panel ends as a result or as one line, never as a traceback."""

import math

import bpy
import numpy as np
import pytest

from blender_addon.engine import pe
from blender_addon.operators import declared
from blender_addon.overlay import layers
from tests.addon import scenes
from tests.thorough import pairs

GREATEST = 2**31 - 1
LEAST = -(2**31)
"""Whole numbers that a property can hold."""
FLOAT_MAX = 3.4028234663852886e38
STOP_AT = {"score_samples": 16_777_216, "search_samples": 16_777_216, "candidates": 10_000_000}
"""Fields that take no more than a study's file does: the greatest would take too much memory."""
NAMES = {
    "line break": "roof\nError: all is lost",
    "colour of a terminal": "\x1b[31mred",
    "turned text": "\u202etoor",
    "blank": " ",
    "formula": "$\\frac{1}$",
    "way out": "../../etc/passwd",
    "as long as it gets": "x" * 63,
}
MUST_BE_REFUSED = ("line break", "colour of a terminal", "turned text")
NUMBERS = (
    ("score_samples", GREATEST),
    ("search_samples", 1),
    ("candidates", GREATEST),
    ("candidates", LEAST),
    ("seed", GREATEST),
    ("seed", LEAST),
    ("focus_index", GREATEST),
    ("beam_limit", LEAST),
    ("beam_length", FLOAT_MAX),
    ("beam_length", math.nan),
)
FACTORS = (0.0, 1e-45, FLOAT_MAX, math.inf, math.nan)
BOUNDS = ((math.nan, 1.0), (-FLOAT_MAX, FLOAT_MAX), (5.0, 5.0), (5.0, -5.0), (1e-45, 2e-45))


@pytest.fixture
def small(car, monkeypatch):
    """Return the car, its LiDAR one of few beams, and few voxels to look at."""
    monkeypatch.setattr(layers.ground_layers, "FINE_M", 8.0)
    monkeypatch.setattr(layers, "BLIND_WITHIN_M", 1.0)
    car.objects["roof"].perception_entropy.model = "Velodyne VLP-16 Puck"
    settings = car.perception_entropy
    settings.score_samples = 1024
    settings.search_samples = 1024
    settings.candidates = 1
    settings.method = "random"
    return car


def said_by(operator, **options) -> str | None:
    """Run an operator; return the line that refused it, None when it went through."""
    try:
        assert operator(**options) == {"FINISHED"}
    except RuntimeError as error:
        text = str(error).strip()
        assert text.startswith("Error: ") and "Traceback" not in text, text
        assert text.isprintable() and len(text) < 500, repr(text)
        return text
    return None


def assert_drawn_sound(scene):
    """What the 3D view shows is finite, whatever the scene holds."""
    small_view = scene.perception_entropy.view
    small_view.beams_of = "ALL"
    small_view.show_reach = True
    small_view.show_heat = True
    for shapes in scenes.drawn(scene).values():
        for shape in shapes.values():
            for each in (shape.lines, shape.faces, shape.through, shape.thin):
                assert np.isfinite(each.points).all() and np.isfinite(each.colors).all()


def score_and_export(folder) -> list[str | None]:
    """What they say; a search reads the scene as they do, and takes longer."""
    path = str(folder / "study.toml")
    return [said_by(bpy.ops.pe.score), said_by(bpy.ops.pe.export_file, filepath=path)]


@pytest.mark.filterwarnings("error")
def test_numbers_at_their_limits(small, tmp_path):
    for name, value in NUMBERS:
        of_view = name.startswith("beam")
        settings = small.perception_entropy.view if of_view else small.perception_entropy
        before = getattr(settings, name)
        setattr(settings, name, value)
        if value == GREATEST and name in STOP_AT:
            assert getattr(settings, name) == STOP_AT[name]
        elif of_view:
            assert_drawn_sound(small)
        else:
            said_by(bpy.ops.pe.optimize)
        setattr(settings, name, before)
    bpy.ops.pe.add_row(rows="focus", kind="custom")
    (focus,) = small.perception_entropy.focus
    for focus.factor in FACTORS:
        said = score_and_export(tmp_path)
        if math.isnan(focus.factor):
            assert all("focus 1 (Focus 1): factor: expected" in line for line in said)
    focus.factor = 2.0
    for bounds in BOUNDS:
        focus.x_range = bounds
        said = score_and_export(tmp_path)
        if not bounds[0] < bounds[1]:
            assert all("focus 1 (Focus 1): x: expected two" in line for line in said)
    bpy.ops.pe.remove_row(rows="focus")
    assert said_by(bpy.ops.pe.score) is None


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("kind", "what"), pairs(NAMES, ["sensor", "part", "fusion", "model", "focus", "boxes"])
)
def test_names(small, tmp_path, what, kind):
    """Names that a terminal or a page would act on are refused, in a line that shows them."""
    sensor = small.objects["roof"]
    name = NAMES[kind]
    if what == "sensor":
        sensor.name = name
    elif what == "part":
        small.objects["body"].name = name
    elif what == "focus":
        bpy.ops.pe.add_row(rows="focus")
        small.perception_entropy.focus[0].name = name
        small.perception_entropy.focus[0].factor = math.nan  # so that its name is told
    elif what == "boxes":
        small.perception_entropy.prior = "boxes"
        small.perception_entropy.boxes = name
    else:
        setattr(sensor.perception_entropy, what, name)
    said = score_and_export(tmp_path)
    if kind in MUST_BE_REFUSED or what in ("model", "focus", "boxes"):
        assert all(said)
    assert said_by(bpy.ops.pe.select_object, name=sensor.name) is None


def test_files_that_cannot_be_written(small, tmp_path, small_pictures):
    (tmp_path / "file").touch()
    for file in ("", "x" * 300, "file/below", ".."):
        path = str(tmp_path / file) if file else ""
        assert "expected" in said_by(bpy.ops.pe.export_file, filepath=path), file
    below = str(tmp_path / "file" / "below")
    assert "expected" in said_by(bpy.ops.pe.export_file, filepath=below)


class Reporter:
    """Stands for an operator: notes what it reports."""

    def report(self, level, text):
        self.level = level
        self.text = text


def test_a_report_is_one_line_whatever_it_quotes():
    operator = Reporter()
    declared.report(operator, "INFO", "Wrote a\nb\u202e\x1b.toml" + "x" * 1000)
    assert operator.level == {"INFO"}
    assert operator.text.startswith("Wrote a\\nb\\u202e\\x1b.toml")
    assert operator.text.isprintable() and len(operator.text) < 500


def test_too_little_memory_is_one_line(small, monkeypatch):
    def no_memory(*_, **__):
        raise MemoryError("Unable to allocate 64 GiB for an array")

    monkeypatch.setattr(pe.Study, "evaluator", no_memory)
    line = said_by(bpy.ops.pe.score)
    assert "Not enough memory" in line and "64 GiB" in line
    assert not small.perception_entropy.has_result
