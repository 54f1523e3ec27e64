"""What the pages say of the code holds: worked numbers, figures, paths, sources."""

import functools
import importlib.util
import re
import sys
from pathlib import Path

import pytest

from pe_core.metric.entropy import ap_of_entropy

ROOT = Path(__file__).parents[2]
FIGURES = ROOT / "docs" / "figures"
ENGINE = (ROOT / "docs" / "engine.md").read_text("utf-8")
PAGES = [
    *sorted(ROOT.glob("*.md")),
    *sorted((ROOT / "docs").rglob("*.md")),
    *(ROOT / room / "README.md" for room in ("benchmarks", "blend_assets")),
]
GUIDE = (ROOT / "docs" / "guide.md").read_text("utf-8")
IMAGES = ROOT / "docs" / "images"
MAX_STILL_BYTES = 400_000
MAX_FILM_BYTES = 3_000_000


@pytest.fixture(scope="module")
def figures(request):
    """The scripts beside the figures: `worked` and `kernels`."""
    found = {}
    sys.path.insert(0, str(FIGURES))
    for name in ("worked", "svg", "kernels"):
        spec = importlib.util.spec_from_file_location(name, FIGURES / f"{name}.py")
        found[name] = sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(found[name])
    yield found
    sys.path.remove(str(FIGURES))
    for name in found:
        del sys.modules[name]


@pytest.fixture
def worked(figures):
    return figures["worked"]


def test_the_bracket_worked_by_hand_is_the_kernel_s(worked):
    """Windows by formulas on plain numbers; rows and columns by the kernel; m by the definition."""
    by_hand = worked.bracketed()
    kernel = worked.kernel_bracket()
    outer = by_hand.outer
    inner = by_hand.inner
    assert outer.rows == list(range(int(kernel.row[0]), int(kernel.row[0] + kernel.rows[0])))
    first = int(kernel.column[0])
    assert outer.columns == list(range(first, first + int(kernel.columns[0])))
    assert (inner.beams, outer.beams) == (kernel.lower[0], kernel.upper[0]) == (12, 20)
    assert inner.beams < worked.defined(worked.TILTED, worked.TILTED_CENTER) < outer.beams


def test_figures_are_what_their_script_draws(figures):
    drawn = figures["kernels"].FIGURES["bracket.svg"]()
    assert (ROOT / "docs" / "images" / "bracket.svg").read_text("utf-8") == drawn
    assert "(images/bracket.svg)" in ENGINE


WITH_PATHS = ["blender", "command_line", "engine", "exchange", "glossary", "labels_and_lenses"]
WITH_PATHS += ["long_runs", "metric", "mounts_and_search", "objects", "optimize", "results"]
WITH_PATHS += ["review", "seeing", "study"]
"""Pages in which names of files and folders of the code stand between backticks."""


def paths_named(text):
    """Paths of files and folders between backticks, without what follows a colon."""
    return re.findall(r"`([\w./]+(?:\.py|/))(?::[^`]*)?`", text)


def test_paths_that_pages_name_are_there():
    """From the checkout's root, from the engine's, or from that of a room of LiDARs or cameras."""
    rooms = ("", "pe_core", "pe_core/sensors", "pe_core/scoring", "pe_tools")
    places = [ROOT / room for room in (*rooms, "pe_core/sensors/lidar", "pe_core/sensors/camera")]
    named = [
        (page.name, path)
        for page in (ROOT / "README.md", *(ROOT / "docs" / f"{name}.md" for name in WITH_PATHS))
        for path in paths_named(page.read_text("utf-8"))
    ]
    assert len(named) > 20
    assert [at for at in named if not any((place / at[1]).exists() for place in places)] == []


def anchor(heading):
    """The anchor that GitHub gives a heading: lower case, no punctuation, hyphens for spaces."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w -]", "", text.strip().lower()).replace(" ", "-")


@functools.cache
def anchors(page):
    text = re.sub(r"^```.*?^```", "", page.read_text("utf-8"), flags=re.S | re.M)
    return {anchor(heading) for heading in re.findall(r"^#+ (.*)$", text, re.M)}


def test_links_of_pages_lead_to_a_file_and_a_heading():
    dead = []
    for page in PAGES:
        text = re.sub(r"^```.*?^```", "", page.read_text("utf-8"), flags=re.S | re.M)
        for link in re.findall(r"\]\(([^)\s]+)\)", text):
            if re.match(r"\w+:", link):
                continue
            path, _, name = link.partition("#")
            target = page.parent / path if path else page
            if not target.exists() or (name and name not in anchors(target)):
                dead.append((page.name, link))
    assert not dead


def test_functions_that_the_table_of_equations_names_are_there():
    table = (ROOT / "docs" / "metric.md").read_text("utf-8")
    named = re.findall(r"`([\w/]+\.py): (\w+)`", table)
    assert len(named) == 8
    for path, function in named:
        room = ROOT / "pe_core" / ("" if path.startswith("metric") else "sensors")
        assert f"\ndef {function}(" in (room / path).read_text("utf-8"), function


def test_what_a_number_means_is_the_metric_s():
    """Each pair of nats and AP on the page."""
    text = " ".join((ROOT / "docs" / "metric.md").read_text("utf-8").split())
    pairs = re.findall(r"([\d.]+\d)(?: nats)? is AP ([\d.]+\d)", text)
    assert len(pairs) == 3
    for nats, ap in pairs:
        digits = len(ap.partition(".")[2])
        assert f"{float(ap_of_entropy(float(nats))):.{digits}f}" == ap, nats


def test_every_picture_of_the_guide_is_there_and_made_by_the_script():
    wanted = re.findall(r"\(images/([\w.]+)\)", GUIDE)
    assert len(wanted) > 8
    scripts = "".join(path.read_text("utf-8") for path in (ROOT / "tools/shots").glob("*.py"))
    for name in wanted:
        assert (IMAGES / name).is_file(), name
        assert f'"{Path(name).stem}"' in scripts, name


def test_pictures_are_small():
    for path in IMAGES.glob("*.png"):
        assert path.stat().st_size < MAX_STILL_BYTES, path.name
    for path in IMAGES.glob("*.webp"):
        assert path.stat().st_size < MAX_FILM_BYTES, path.name


def test_readme_is_one_screen():
    """It says what is published, and what each platform is: tested, or expected to work."""
    text = (ROOT / "README.md").read_text("utf-8")
    assert len(text.splitlines()) <= 90
    assert "Nothing is published yet" in text and "**Should work:**" in text
