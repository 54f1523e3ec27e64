"""What every command line shares: the parser and the exit status. Used by `pe`, by `blender
--command pe` and by bpy as a module, so that they behave alike."""

import argparse
import shlex
import signal
import sys
from collections.abc import Callable, Sequence
from typing import Any, NoReturn, TextIO

from pe_core.base import dump_json
from pe_core.base.errors import InputError, one_of
from pe_core.base.files import named_path, quoted, reason_of
from pe_core.base.input_files import noting_inputs

from .interrupts import FATAL, signals_interrupt
from .run_job import print_answer
from .terminal import BAD_INPUT, Answer, one_line, printable, show, tell

NO_THREAD = "can't start new thread"
"""Python's `RuntimeError` where no memory is left for the stack of a thread."""

PATHS = ("STUDY", "FILE", "MESH", "PATH", "TABLE", "DIR")
"""Metavars of arguments that are files or folders."""


class Parser(argparse.ArgumentParser):
    """A parser whose messages are printable text, and whose printing never fails. `described`
    returns what ``--help --json`` prints; None: as ``--help``."""

    described: Callable[[], dict[str, Any]] | None = None
    _in_json = False

    def format_help(self) -> str:
        """Return the help; with ``--json`` as data."""
        if self._in_json and self.described is not None:
            return dump_json(self.described())
        return super().format_help()

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse arguments; raise `InputError` for a path that no file can have."""
        self._in_json = "--json" in (args or ())
        found, rest = super().parse_known_args(args, namespace)
        for word in rest if self.get_default("function") else ():  # a verb has all of its options
            if word.startswith("-"):
                self.error(f"{word}: expected {one_of(self._option_string_actions, word)}")
        for action in self._actions:
            if (where := action.metavar) in PATHS:
                given = getattr(found, action.dest, None)
                for path in [given] if isinstance(given, str) else given or ():
                    named_path("command line", "/".join(action.option_strings) or where, path)
        return found, rest

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            expected = f"expected {one_of(action.choices, value)}, found {quoted(value)}"
            raise argparse.ArgumentError(action, expected)

    def error(self, message: str) -> NoReturn:
        """Print the usage and the error, and exit with status 2."""
        super().error(one_line(message))

    def _print_message(self, message: str, file: Any = None) -> None:
        show(printable(message), file or sys.stderr)


def as_typed(prog: str, argv: Sequence[str]) -> str:
    """Return a command line quoted for a shell: the program and its arguments."""
    return " ".join([prog, *map(shlex.quote, argv)])


def run(main: Callable[[], Answer], out: TextIO | None = None) -> int:
    """Run a command, print its text on `out` (stdout), and return its exit status. Bad input is one
    line on stderr and status 1; a signal that ends the command is 128 and its number: 130 for
    Ctrl-C, 143 for SIGTERM, 129 for SIGHUP."""
    try:
        with signals_interrupt(), noting_inputs():
            text, status = main()
        return print_answer(text, status, out or sys.stdout)
    except InputError as error:
        tell(str(error))
        return BAD_INPUT
    except KeyboardInterrupt as error:
        note = getattr(error, "note", "")
        tell(f"interrupted; {note}" if note else "interrupted")
        return FATAL + getattr(error, "signum", signal.SIGINT)
    except (MemoryError, RuntimeError) as error:
        if isinstance(error, RuntimeError) and str(error) != NO_THREAD:
            raise
        tell("not enough memory: close other programs, or ask for fewer voxels (--samples)")
        return BAD_INPUT
    except BrokenPipeError as error:  # from a stream that a verb writes to directly
        tell(str(error))
        return BAD_INPUT
    except OSError as error:  # from a question to the system about a file
        tell(str(file_error(error)))
        return BAD_INPUT


def file_error(error: OSError) -> InputError:
    """Return the line about a file that the system refuses."""
    return InputError(error.filename or "system", "file", "one that can be used", reason_of(error))
