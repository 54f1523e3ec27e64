"""The command as data: what ``--help --json`` prints, of the same parsers as ``--help``."""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Protocol

from pe_core.base import record, schemas_of_records
from pe_core.base.setting import AtTimes

from .terminal import EXIT_STATUSES


@dataclass(frozen=True, slots=True)
class ArgumentRecord:
    """An argument of a verb. `flags`: of an option, else none. `value`: what stands for its value;
    None for one without. `several`: whether it takes several values, or may be repeated."""

    name: str
    flags: tuple[str, ...]
    about: str
    value: str | None
    required: bool
    several: bool
    choices: Annotated[tuple[str, ...] | None, AtTimes] = None
    default: Annotated[Any, AtTimes] = None


@dataclass(frozen=True, slots=True)
class VerbRecord:
    """A verb, and its arguments."""

    name: str
    group: str
    about: str
    arguments: tuple[ArgumentRecord, ...]


@dataclass(frozen=True, slots=True)
class CommandRecord:
    """A command: its verbs, what its exit statuses mean, the schema of what each verb prints with
    ``--json``."""

    program: str
    version: str
    verbs: tuple[VerbRecord, ...]
    exit_statuses: Mapping[int, str]
    answers: Mapping[str, Any]


class DescribedVerb(Protocol):
    """A row of the verbs, as far as it is described."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def group(self) -> str:
        """Its group in the help."""

    @property
    def about(self) -> str:
        """Its meaning."""

    @property
    def answer(self) -> Any:
        """The type of what it prints with ``--json``."""


def described(
    program: str, version: str, parsers: Sequence[tuple[DescribedVerb, argparse.ArgumentParser]]
) -> dict[str, Any]:
    """Return a command with some of its verbs as plain data."""
    verbs = tuple(
        VerbRecord(verb.name, verb.group, verb.about, tuple(_arguments(parser)))
        for verb, parser in parsers
    )
    answers = schemas_of_records({verb.name: verb.answer for verb, _ in parsers})
    command = CommandRecord(
        program=program, version=version, verbs=verbs, exit_statuses=EXIT_STATUSES, answers=answers
    )
    found: dict[str, Any] = record(command)
    return found


def _arguments(parser: argparse.ArgumentParser) -> Iterator[ArgumentRecord]:
    for each in parser._actions:
        if each.default == argparse.SUPPRESS:  # the help
            continue
        is_repeated = isinstance(each.default, list)
        metavar = each.metavar if isinstance(each.metavar, str) else " ".join(each.metavar or ())
        yield ArgumentRecord(
            name=each.dest,
            flags=tuple(each.option_strings),
            about=(each.help or "") % {**vars(each), "prog": parser.prog},
            value=None if each.nargs == 0 else metavar or each.dest.upper(),
            required=each.required,
            several=is_repeated
            or each.nargs in ("+", "*")
            or (isinstance(each.nargs, int) and each.nargs > 1),
            choices=None if each.choices is None else tuple(map(str, each.choices)),
            default=None if is_repeated else each.default,
        )
