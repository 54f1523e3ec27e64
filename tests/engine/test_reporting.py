"""How far a job is: a bar with the time left on a terminal, lines elsewhere, never a failure."""

import io
import re

import pytest

from pe_core.base import plugins
from pe_tools.cli import progress_line
from pe_tools.cli.progress_line import Reporter
from pe_tools.jobs import Progress


class Screen(io.StringIO):
    """A stream somebody looks at."""

    encoding = "utf-8"

    def isatty(self):
        return True


SCORING = [Progress("scoring the start", 0.0), Progress("scoring the start", 0.5)]
SEARCHING = [Progress("optimizing", k / 4, 1.5 - 0.1 * k, k) for k in range(5)]


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    monkeypatch.setattr(progress_line, "REPORT_EVERY_S", {True: 0.0, False: 0.0})


def told(stream):
    reporter = Reporter(stream)
    for progress in SCORING + SEARCHING:
        reporter.report(progress)
    reporter.clear()
    return stream.getvalue()


def test_a_terminal_shows_the_time_that_is_left():
    text = told(Screen())
    assert re.search(r"optimizing  25% \|#{6} +\| \d\d:\d\d<\?, entropy 1\.4000", text)
    assert re.search(r"scoring the start  50% \|", text)
    assert "\n" not in text and text.endswith("\r\x1b[K"), "the bar is taken away"


def test_a_log_has_lines_and_no_bar():
    lines = told(io.StringIO()).splitlines()
    assert lines[0] == "scoring the start   0%" and lines[-1] == "optimizing 100%  entropy 1.1000"
    assert len(lines) == len(SCORING + SEARCHING)


@pytest.mark.parametrize("stream", [Screen, io.StringIO])
def test_what_takes_long_is_told_once_and_without_its_preparation(stream, monkeypatch):
    """12 s to prepare, then 1 % a second: after 3 s of that, 96 s are left."""
    now = [0.0]
    monkeypatch.setattr(progress_line.time, "monotonic", lambda: now[0])
    screen = stream()
    reporter = Reporter(screen)
    for second in range(60):
        now[0] = float(second)
        reporter.report(Progress("scoring", max(0, second - 12) / 100))
    assert re.findall(r"scoring: about \d+ s left\n", screen.getvalue()) == [
        "scoring: about 96 s left\n"
    ]
    quick = stream()
    reporter = Reporter(quick)
    for second in range(20):
        now[0] = 100.0 + second
        reporter.report(Progress("scoring", second / 20))
    assert "about" not in quick.getvalue()


def test_a_terminal_that_goes_away_ends_nothing():
    class Gone(Screen):
        def write(self, text):
            raise OSError("input/output error")

    assert told(Gone()) == ""


def test_extras_are_those_that_the_project_offers():
    import tomllib
    from pathlib import Path

    project = Path(plugins.__file__).parents[2] / "pyproject.toml"
    offered = tomllib.loads(project.read_text("utf-8"))["project"]["optional-dependencies"]
    name = plugins.EXTRAS["distributed"]
    assert any(need.startswith("distributed") for need in offered[name])
    assert any(need.startswith("distributed") for need in offered["test"]), "tests are not skipped"
