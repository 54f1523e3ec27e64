"""`pe serve`: a session over a pipe. Each line of standard input is a request in JSON, and each is
answered by one line on standard output. A request names a verb and has its options as keys, so
that what a verb takes is declared once; `load`, `set` and `move` change the study of the session.
"""

import argparse
import contextlib
import io
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn, Protocol, TextIO

import numpy as np

from pe_core.base import dump_json, parse_json, record
from pe_core.base.errors import InputError, require_keys, require_name, shown
from pe_core.base.recent_cache import RecentCache
from pe_core.base.table_reader import dotted, finite, inline
from pe_core.study import Study, load_study_data

from ..jobs import Job, StudyEvaluators, placements
from ..sweep import SOURCE, changed_study, read_changes
from .answers import ReplyError, ServeReply, SessionState
from .command import Parser, file_error
from .interrupts import FATAL
from .options import OptionRow, option
from .study_source import StudyFiles, naming_study, with_changes
from .terminal import BAD_INPUT, DONE, USAGE, Answer, one_line, printable, show

SERVED = ("score", "explain", "check", "where", "region", "export")
"""Verbs of the command that a session has, too, on its study."""
REQUEST = "request"
MAX_LINE_BYTES = 1 << 20
"""Longer lines are refused: no request needs them, and one without end would fill the memory."""
OPTION = "-"  # Begins a flag
HEAD = ("id", "do")
OF_POSE = ("position", "rotation")


class ServedVerb(Protocol):
    """A row of the verbs, as far as a session uses it."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def options(self) -> str:
        """Names of its options."""

    def add(self, verbs: Any, source: StudyFiles) -> Parser:
        """Add it to a parser; return its own."""


class SessionStudy(StudyFiles):
    """The study of a session, as the source of verbs; `host` is the source of the command."""

    def __init__(self, host: StudyFiles) -> None:
        self._host = host
        self._study: Study | None = None
        # Two: a check of presets beside the study's own requirements is another problem.
        self._evaluators = RecentCache[StudyEvaluators](2)
        self.name = "session"
        self.versions = host.versions
        self.notes = host.notes  # type: ignore[method-assign]

    @property
    def current(self) -> Study:
        """The study as it is now; at first that of the host. `InputError` where there is none."""
        if self._study is None:
            self._study = self._host.opened()
        return self._study

    def put(self, study: Study, name: str = "") -> None:
        """Take a study, with the name of its file if it is another."""
        self._study = study
        self.name = name or self.name

    def add_arguments(self, verb: argparse.ArgumentParser, takes: str) -> None:
        """Add nothing: there is one study."""

    def study(self, args: argparse.Namespace) -> Study:
        """Return the study with the changes of one request."""
        return self.changed(self.current, args, self.name)

    def share_evaluators(self, job: Job) -> None:
        """Give a job the evaluators of the last one, where only the rig has changed since: what
        has not moved is not measured again."""
        kept = self._evaluators.made(job.evaluators.key, lambda: job.evaluators)
        job.evaluators = kept
        job.as_drawn = kept.as_drawn

    @contextlib.contextmanager
    def naming(self, _: argparse.Namespace) -> Iterator[None]:
        """Have errors of the study name its file, within."""
        with naming_study(self.name):
            yield


class _RequestParser(Parser):
    """A parser whose errors are raised."""

    def error(self, message: str) -> NoReturn:
        """Raise an error of the usage."""
        raise _WrongUsage(one_line(message))


class _WrongUsage(Exception):
    """A request that the verb does not take."""


class Session:
    """A session: its study, and the verbs that it has."""

    def __init__(self, host: StudyFiles, rows: Sequence[ServedVerb]) -> None:
        self._source = SessionStudy(host)
        self._own: dict[str, Callable[[Mapping[str, Any]], SessionState]] = {
            "load": self._load,
            "set": self._set,
            "move": self._move,
        }
        self._parser = _RequestParser(prog=REQUEST)
        verbs = self._parser.add_subparsers(required=True, metavar="VERB")
        self._verbs: dict[str, dict[str, OptionRow]] = {}
        for verb in rows:
            verb.add(verbs, self._source)
            names = verb.options.replace("|", " ").split()
            flags = (option(name) for name in names)
            self._verbs[verb.name] = {row.flags[-1].lstrip(OPTION): row for row in flags}

    def reply(self, line: bytes) -> ServeReply:
        """Answer a request. Bad input is a reply with an error."""
        do: str | None = None
        number: Any = None
        notes = io.StringIO()
        try:
            with contextlib.redirect_stderr(notes):
                request = _request(line)
                number = request.get("id")
                do = request["do"]
                status, answer = self._answer(do, request)
        except (InputError, OSError) as error:
            wrong = error if isinstance(error, InputError) else file_error(error)
            return ServeReply(id=number, do=do, status=BAD_INPUT, error=_reply_error(wrong))
        except _WrongUsage as error:
            wrong = InputError(REQUEST, "", "", str(error))
            return ServeReply(id=number, do=do, status=USAGE, error=_reply_error(wrong))
        lines = tuple(each.removeprefix("pe: ") for each in notes.getvalue().splitlines())
        return ServeReply(id=number, do=do, status=status, notes=lines, answer=answer)

    def _answer(self, do: str, request: Mapping[str, Any]) -> tuple[int, Any]:
        require_name(REQUEST, "do", do, [*self._own, *self._verbs])
        if do in self._own:
            return DONE, self._own[do](request)
        rows = self._verbs[do]
        require_keys(REQUEST, "", request, [*HEAD, *rows])
        words = [do, "--json"]
        for key, row in rows.items():
            if request.get(key) is not None:
                words += _words(key, row, request[key])
        args = self._parser.parse_args(words)
        args.command_line = ""
        with self._source.naming(args):
            text, status = args.function(self._source, args)
        return status, parse_json(do, text)

    def _load(self, request: Mapping[str, Any]) -> SessionState:
        require_keys(REQUEST, "", request, [*HEAD, "study", "set"])
        name = _text(request, "study")
        changes = read_changes(_changes("set", request.get("set", {})))
        path = Path(name)
        self._source.put(changed_study(load_study_data(path), changes, name, path.parent), name)
        return self._state()

    def _set(self, request: Mapping[str, Any]) -> SessionState:
        require_keys(REQUEST, "", request, [*HEAD, "changes"])
        changes = read_changes(_changes("changes", request.get("changes")))
        self._source.put(with_changes(self._source.current, changes, self._source.name))
        return self._state()

    def _move(self, request: Mapping[str, Any]) -> SessionState:
        require_keys(REQUEST, "", request, [*HEAD, "sensor", *OF_POSE])
        sensor = _text(request, "sensor")
        require_name(REQUEST, "sensor", sensor, [each.name for each in self._source.current.rig])
        keys = {f"sensor.{dotted(sensor)}.{key}": request[key] for key in OF_POSE if key in request}
        if not keys:
            raise InputError(REQUEST, "position", "position, rotation or both", "neither")
        changes = read_changes(_changes("", keys))
        self._source.put(with_changes(self._source.current, changes, self._source.name))
        return self._state()

    def _state(self) -> SessionState:
        study = self._source.current
        return SessionState(self._source.name, study.vehicle_line, placements(study.rig, study))


def serve(source: StudyFiles, args: argparse.Namespace) -> Answer:
    """Answer requests until standard input ends. A request that fails ends nothing."""
    session = Session(source, [row for row in args.rows if row.name in SERVED])
    out = source.out or sys.stdout
    for line in _lines(sys.stdin):
        reply = session.reply(line)
        text = dump_json(finite(record(reply)), indent=None)
        if show(printable(text, getattr(out, "encoding", None)), out) is not None:
            return "", BAD_INPUT  # nobody reads
        if reply.status > FATAL:
            return "", reply.status
    return "", DONE


def _lines(stream: TextIO | None) -> Iterator[bytes]:
    """Yield the lines of a stream that are not empty; of one that is too long its beginning."""
    raw = io.BytesIO() if stream is None else stream.buffer
    while line := raw.readline(MAX_LINE_BYTES + 1):
        rest = line
        while len(rest) > MAX_LINE_BYTES and not rest.endswith(b"\n"):
            rest = raw.readline(MAX_LINE_BYTES + 1)
        if line.strip():
            yield line


def _request(line: bytes) -> dict[str, Any]:
    """Return the table of a request; `InputError` for another line."""
    if len(line) > MAX_LINE_BYTES:
        raise InputError(REQUEST, "line", f"at most {MAX_LINE_BYTES:,} bytes", "more")
    data = parse_json(REQUEST, line)
    if not isinstance(data, dict):
        raise InputError(REQUEST, "line", 'a table, as {"do": "score"}', shown(data))
    _text(data, "do")
    return data


def _text(request: Mapping[str, Any], key: str) -> str:
    value = request.get(key)
    if not isinstance(value, str) or not value:
        raise InputError(REQUEST, key, "a text", "nothing" if value is None else shown(value))
    return value


def _changes(key: str, table: Any) -> list[str]:
    """Return changes of keys as they are typed, of a table of keys and values."""
    if not isinstance(table, dict) or any(value is None for value in table.values()):
        raise InputError(REQUEST, key, 'a table, as {"samples": 4096}', shown(table))
    return [f"{name}={inline(value)}" for name, value in table.items()]


def _words(key: str, row: OptionRow, value: Any) -> list[str]:
    """Return an option as it is typed."""
    flag = row.flags[-1]
    if not flag.startswith(OPTION):  # an argument without a flag, such as the sensor of `region`
        word = _word(key, value)
        if word.startswith(OPTION):
            raise InputError(REQUEST, key, "a text that is no option", shown(word))
        return [word]
    action = row.arguments.get("action")
    if action == "store_true":
        if not isinstance(value, bool):
            raise InputError(REQUEST, key, "true or false", shown(value))
        return [flag] if value else []
    if isinstance(value, dict):
        return [f"{flag}={each}" for each in _changes(key, value)]
    values = [_word(key, each) for each in (value if isinstance(value, list) else [value])]
    if isinstance(value, list) and action != "append":
        if wrong := [each for each in value if isinstance(each, str) and each.startswith(OPTION)]:
            raise InputError(REQUEST, key, "texts that are no options", shown(wrong[0]))
        return [flag, *values]
    return [f"{flag}={each}" for each in values]


def _word(key: str, value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(REQUEST, key, "a text or a number", shown(value))
    # Without an exponent: the parser would take -1e-05 for an option.
    return str(value) if isinstance(value, int) else np.format_float_positional(value, trim="-")


def _reply_error(error: InputError) -> ReplyError:
    error = error.at(REQUEST) if error.source == SOURCE else error
    return ReplyError(
        text=one_line(str(error)),
        source=error.source,
        field=error.field,
        expected=error.expected,
        found=str(error.found),
    )
