"""What is printed: nothing steers the terminal, nothing fails, progress is shown."""

import io
import re
import subprocess
import sys

import pytest

from pe_core.search import Value
from pe_tools.cli import progress_line
from pe_tools.cli.progress_line import Reporter
from pe_tools.cli.terminal import MAX_LINE_LENGTH, one_line, printable
from pe_tools.cli.verbs import main
from pe_tools.jobs import Progress
from pe_tools.versions import versions_text

STEERING = {
    "\x1b[31m": r"\u001b[31m",
    "a\rb\tc": r"a\u000db\u0009c",
    "\x9b2J": r"\u009b2J",
    "abc\u202ecba": r"abc\u202ecba",
    "\u2066x\u2069\u200b": r"\u2066x\u2069\u200b",
    "\u2028\udc80": r"\u2028\udc80",
    "\U000e0041": r"\udb40\udc41",
}
SCORING = [Progress("scoring the start", 0.0), Progress("scoring the start", 0.5)]
SEARCHING = [Progress("optimizing", k / 4, Value(0.0, 1.5 - 0.1 * k), k) for k in range(5)]


@pytest.mark.parametrize("text", STEERING)
def test_what_would_steer_the_terminal_is_escaped(text):
    assert printable(text) == STEERING[text]


def test_what_the_encoding_has_no_word_for_is_escaped():
    assert printable("\u00fc\u8eca", "latin-1") == "\u00fc\\u8eca"


def test_a_message_is_one_short_line():
    assert one_line("two\nlines") == "two lines"
    assert len(one_line("x" * 10**6)) == MAX_LINE_LENGTH + 3


def status_of(argv):
    try:
        return main(argv)
    except SystemExit as stop:
        return stop.code


@pytest.mark.parametrize(
    "argv",
    [
        ["score", "\x1b[2Jno\x07ne\u202e.toml"],
        ["\x1b[2Jfly"],
        ["score", "x", "--\x1b]0;title\x07"],
        ["score", "x", "--workers", "\x1b[2J"],
        ["sensors", "\u202eraldnaP"],
    ],
)
def test_arguments_come_back_escaped(argv, capsys):
    assert status_of(argv) in (1, 2)
    out, err = capsys.readouterr()
    assert out == "" and printable(err) == err and "\\" in err


@pytest.mark.parametrize("value", ["-1", "1025", "9" * 5000, "1.5", "\u0663", "", "+4", "many"])
def test_workers_are_a_whole_number_of_moderate_size(value, capsys):
    assert status_of(["score", "x.toml", "--workers", value]) == 2
    err = capsys.readouterr().err
    assert "expected a whole number from 0 to 1024" in err
    assert max(map(len, err.splitlines())) < 200


class Screen(io.StringIO):
    """A stream somebody looks at."""

    encoding = "utf-8"

    def isatty(self):
        return True


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
    assert re.search(r"optimizing  25% \|#{6} +\| \d\d:\d\d<\?, entropy 1\.400", text)
    assert re.search(r"scoring the start  50% \|", text)
    assert "\n" not in text and text.endswith("\r\x1b[K"), "the bar is taken away"


def test_a_log_has_lines_and_no_bar():
    lines = told(io.StringIO()).splitlines()
    assert lines[0] == "scoring the start   0%" and lines[-1] == "optimizing 100%  entropy 1.100"
    assert len(lines) == len(SCORING + SEARCHING)


def test_the_version_is_told_before_anything_is_loaded():
    """Neither NumPy nor the verbs: a script that asks for the version does not wait for them."""
    code = "import sys; from pe_tools.__main__ import main; sys.argv = ['pe', '--version']; main()"
    code += "; print(sorted({'numpy', 'pe_tools.cli'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    told, loaded = done.stdout.splitlines()
    assert told == versions_text()
    assert loaded == "[]"
