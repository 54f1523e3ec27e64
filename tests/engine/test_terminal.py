"""What is printed: nothing steers the terminal, nothing fails, options have their ranges."""

import io
import json

import pytest

import pe_core as pe
from pe_core.base import dump_json
from pe_tools.cli import command, show
from pe_tools.cli.terminal import MAX_LINE_LENGTH, one_line, printable
from pe_tools.cli.verbs import main

STEERING = {
    "\x1b[31m": r"\u001b[31m",
    "a\rb\tc": r"a\u000db\u0009c",
    "\x9b2J": r"\u009b2J",
    "abc\u202ecba": r"abc\u202ecba",
    "\u2066x\u2069\u200b": r"\u2066x\u2069\u200b",
    "\u2028\udc80": r"\u2028\udc80",
    "\U000e0041": r"\udb40\udc41",
}


@pytest.mark.parametrize("text", STEERING)
def test_what_would_steer_the_terminal_is_escaped(text):
    assert printable(text) == STEERING[text]


@pytest.mark.parametrize("text", ["", "plain\nlines\n", "Dach-Lidar \u00fc \u8eca \U0001f697"])
def test_all_else_stays(text):
    assert printable(text) == text


def test_what_the_encoding_has_no_word_for_is_escaped():
    assert printable("\u00fc\u8eca", "latin-1") == "\u00fc\\u8eca"


@pytest.mark.parametrize("text", STEERING)
def test_json_means_the_same_afterwards(text):
    data = {text: [text]}
    shown = printable(dump_json(data), "ascii")
    assert json.loads(shown) == data and shown.isascii()


def test_a_message_is_one_short_line():
    assert one_line("two\nlines") == "two lines"
    assert len(one_line("x" * 10**6)) == MAX_LINE_LENGTH + 3


def test_a_stream_that_fails_says_so_and_raises_nothing():
    closed = io.StringIO()
    closed.close()
    assert isinstance(show("text", closed), ValueError)
    assert show("text", None) is None


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


@pytest.mark.parametrize("option", ["--grid-samples", "--seed", "--samples", "--candidates"])
def test_every_option_of_a_number_has_a_range(option, capsys):
    assert status_of(["optimize", "x.toml", option, "1" + "0" * 30]) == 2
    assert "expected a whole number from 0 to " in capsys.readouterr().err


def test_the_greatest_values_are_taken():
    count = command.count_up_to(1024)
    assert [count("0"), count("1024"), count("0007")] == [0, 1024, 7]


def test_a_name_that_steers_the_terminal_is_refused_and_shown_escaped(tmp_path, capsys):
    sensor = pe.Sensor("roof", pe.catalog.load("Pandar64"), pe.Pose((0.0, 0.0, 2.0)))
    path = tmp_path / "car.toml"
    pe.export_study(pe.Study(pe.Rig([sensor])), path)
    text = path.read_text("utf-8")
    path.write_text(text.replace('"roof"', '"roof\u202e"'), "utf-8")
    status = main(["score", str(path), "--grid-samples", "2048"])
    out, err = capsys.readouterr()
    assert (status, out) == (1, "")
    assert "\u202e" not in out + err and r"\u202e" in out + err
