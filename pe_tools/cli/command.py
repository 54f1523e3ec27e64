"""What every command line shares: parser, options, the verb ``sensors``, exit status. Used by `pe`,
by `blender --command pe` and by bpy as a module, so that they behave alike."""

import argparse
import shlex
import signal
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NoReturn, TextIO

from pe_core import catalog
from pe_core.base.errors import InputError, one_of
from pe_core.base.files import named_path, quoted, reason_of
from pe_core.base.input_files import noting_inputs
from pe_core.search import LIMITED, ON_FRONT, Limits, Schedule
from pe_core.search.goals import Front, Start
from pe_core.sensors import CURVE_MODELS, KINDS, curve_source, detectors, fitted_curves, kind_of
from pe_core.sensors.lidar import RETURNS
from pe_core.study import METHODS, OBJECTIVES, SCHEDULED_METHOD, Study, load_study

from .interrupts import FATAL, signals_interrupt
from .run_job import print_answer
from .terminal import BAD_INPUT, DONE, Answer, one_line, printable, show, tell

NO_THREAD = "can't start new thread"
"""Python's `RuntimeError` where no memory is left for the stack of a thread."""
MAX_WORKERS, MAX_VOXELS, LAST_SEED = 1024, 10**9, 2**64 - 1
"""Greatest values of options: more threads or voxels than anyone has a use for."""


NOTHING = "none"  # Value of `--limit` that drops the limits of the study
STOPS = {"stop_after": "seconds", "stop_gain": "gain"}
"""Fields of `Stop` by option."""
PATHS = ("STUDY", "FILE", "MESH", "PATH", "TABLE", "DIR")
"""Metavars of arguments that are files or folders."""


class Parser(argparse.ArgumentParser):
    """A parser whose messages are printable text, and whose printing never fails."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse arguments; raise `InputError` for a path that no file can have."""
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


def add_run_options(parser: argparse.ArgumentParser, *, search: bool) -> None:
    """Add the options of ``score`` and ``optimize`` to a parser."""
    folder = parser.add_mutually_exclusive_group()
    folder.add_argument("-o", "--output", metavar="DIR", help="folder for the results")
    if search:
        about = "go on with the search that was begun in this folder"
        folder.add_argument("--resume", metavar="DIR", help=about)
        about = "begin with each sensor on its mount: one that is not takes the nearest pose there"
        parser.add_argument("--snap", action="store_true", help=about)
    parser.add_argument("--json", action="store_true", help="print result.json on stdout")
    add_score_options(parser)
    if search:
        add_executor_option(parser)
        add_search_options(parser)


def add_executor_option(parser: argparse.ArgumentParser) -> None:
    """Add the option that names an executor to a parser."""
    about = "who works: dask://HOST:PORT, or MODULE:FUNCTION that returns an executor"
    parser.add_argument("--executor", metavar="WHO", help=about)


def add_search_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of a search to a parser."""
    options = (
        ("--seed", LAST_SEED, "seed of the search"),
        ("--candidates", MAX_VOXELS, "of the method random: placements tried in a round"),
        ("--search-samples", MAX_VOXELS, "voxels a candidate is evaluated on (0: all)"),
        ("--evaluations", MAX_VOXELS, "placements evaluated at most (0: as the method says)"),
    )
    about = f"how to search: one of {', '.join(METHODS)}"
    parser.add_argument("--method", choices=METHODS, metavar="NAME", help=about)
    about = "what to improve: the study's entropy, or the expected AP of objects in traffic"
    parser.add_argument("--objective", choices=OBJECTIVES, metavar="|".join(OBJECTIVES), help=about)
    for option, greatest, about in options:
        parser.add_argument(option, type=count_up_to(greatest), metavar="N", help=about)
    add = parser.add_argument
    add("--stop-after", type=number, metavar="S", help="end after so many seconds")
    about = "end when the last placements gained less than this"
    add("--stop-gain", type=number, metavar="VALUE", help=about)
    about = "sensors that stay where they are, besides those of the study"
    add("--fix", type=_names, default=(), metavar="NAME,...", help=about)
    about = "start from the placement of this study, too; any number"
    add("--start", action="append", default=[], metavar="STUDY", help=about)
    about = f"a Pareto front of these: two or more of {', '.join(ON_FRONT)}"
    add("--front", type=_names, metavar="NAME,...", help=about)
    about = f"{', '.join(LIMITED)}: at this limit, or as at the start; none: no limit of the study"
    add("--limit", action="append", type=_limit, metavar="FIGURE[=VALUE]", help=about)


def add_score_options(parser: argparse.ArgumentParser, workers: str = "threads") -> None:
    """Add the options of scoring a study to a parser."""
    voxels, count = count_up_to(MAX_VOXELS), count_up_to(MAX_WORKERS)
    about = "voxels a score looks at (0: all)"
    parser.add_argument("--samples", type=voxels, metavar="N", help=about)
    add_curve_option(parser)
    parser.add_argument("--state", metavar="NAME", help="a state of the study, in place of all")
    parser.add_argument("--weather", metavar="NAME", help="a weather of the study, in place of all")
    parser.add_argument("--workers", type=count, metavar="N", help=f"{workers} (default: all)")


def add_curve_option(parser: argparse.ArgumentParser) -> None:
    """Add the option of the AP curves of whole objects to a parser."""
    about = "AP curves of whole objects: from publications, or of LiDARs from detectors (pe curves)"
    form = "|".join(CURVE_MODELS)
    parser.add_argument("--ap-model", choices=CURVE_MODELS, metavar=form, help=about)
    about = "beams of LiDARs that return: all, or as many as measured in real traffic"
    parser.add_argument("--returns", choices=RETURNS, metavar="|".join(RETURNS), help=about)


def with_curves(study: Study, args: argparse.Namespace) -> Study:
    """Return the study with the AP curves of that option."""
    model, returns = (getattr(args, key, None) for key in ("ap_model", "returns"))
    if model is not None:
        study = replace(study, model=study.model.with_model(model))
    return study if returns is None else replace(study, returns=returns)


def count_up_to(greatest: int, least: int = 0) -> Callable[[str], int]:
    """Return a function that parses a whole number from `least` to `greatest`."""

    def count(text: str) -> int:
        digits = text.isascii() and text.isdecimal() and len(text) <= len(str(greatest))
        if not digits or not least <= int(text) <= greatest:
            expected = f"expected a whole number from {least} to {greatest}, found {quoted(text)}"
            raise argparse.ArgumentTypeError(expected)
        return int(text)

    return count


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def number(text: str) -> float:
    """Return the number of an option."""
    try:
        return float(text)
    except ValueError:
        expected = f"expected a number, found {quoted(text)}"
        raise argparse.ArgumentTypeError(expected) from None


def with_options(study: Study, args: argparse.Namespace) -> Study:
    """Return the study with the changes of the command line's options."""
    if args.samples is not None:
        study = replace(study, samples=args.samples)
    study = with_curves(study, args)
    state, weather = getattr(args, "state", None), getattr(args, "weather", None)
    if state or weather:
        study = study.under(study.conditions.one(state, weather))
    if getattr(args, "snap", False):
        study = _on_mounts(study)
    search = study.search
    if (samples := getattr(args, "search_samples", None)) is not None:
        search = replace(search, samples=samples)
    for name in ("method", "objective", "seed", "evaluations"):
        if (value := getattr(args, name, None)) is not None:
            search = replace(search, **{name: value})
    own, has_schedule = study.search, search.method == SCHEDULED_METHOD or study.selection.choices
    candidates = getattr(args, "candidates", None)
    if candidates is not None:
        if not has_schedule:
            expected = f"--method {SCHEDULED_METHOD}, the only method with candidates"
            raise InputError("command line", "--candidates", expected, search.method)
        search = replace(search, schedule=replace(search.schedule, candidates=candidates))
    elif not has_schedule and own.method == SCHEDULED_METHOD and own.schedule != Schedule():
        tell(f"--method {search.method}: the study's schedule, of {SCHEDULED_METHOD}, is not used")
    return with_goals(replace(study, search=search), args)


def _on_mounts(study: Study) -> Study:
    """Return a study with its sensors on their mounts; those that moved are told."""
    placed = study.on_mounts()
    for sensor in placed.rig:
        if sensor.pose != study.rig[sensor.name].pose:
            at = ", ".join(f"{value:g}" for value in sensor.pose.position)
            tell(f"{sensor.name}: put on its mount, at ({at}) m")
    return placed


def with_goals(study: Study, args: argparse.Namespace) -> Study:
    """Return the study with the changes of these options; `InputError` for an impossible one. A
    verb that does not search has none of them."""
    goals = own = study.search.goals
    given = {field: getattr(args, option, None) for option, field in STOPS.items()}
    stops = {field: value for field, value in given.items() if value is not None}
    goals = replace(goals, stop=replace(goals.stop, **stops)) if stops else goals
    rigs = [(Path(path).stem, load_study(path).rig) for path in getattr(args, "start", ())]
    starts = [Start(name, {s.name: s.pose for s in rig}) for name, rig in rigs]
    goals = replace(goals, starts=(*goals.starts, *starts)) if starts else goals
    if names := getattr(args, "fix", ()):
        goals = replace(goals, fixed=tuple(dict.fromkeys((*goals.fixed, *names))))
    if (names := getattr(args, "front", None)) is not None:
        goals = replace(goals, front=Front(names, goals.front.points))
    limits = study.limits
    if given := dict(getattr(args, "limit", None) or ()):
        limits = Limits() if given.pop(NOTHING, None) is not None else limits
        limits = limits.changed(**given)
    if goals == own and limits == study.limits:
        return study
    changed = replace(study, search=replace(study.search, goals=goals), limits=limits)
    changed.coding()  # a follower that is to stay is bad input, not a late surprise
    return changed


def _limit(text: str) -> tuple[str, float | bool]:
    """Return the figure and the value of ``--limit``; true where there is no value."""
    name, _, value = text.partition("=")
    if name not in (*LIMITED, NOTHING):
        expected = f"expected {one_of((*LIMITED, NOTHING), name)}, found {quoted(name)}"
        raise argparse.ArgumentTypeError(expected)
    return name, int(value) if value.isdecimal() else number(value) if value else True


def add_sensors_verb(verbs: Any) -> None:
    """Add ``sensors``: the catalogue, or one of its entries with a plot of its channels."""
    parser = verbs.add_parser("sensors", help="list the catalogue, or show one sensor")
    parser.add_argument("name", nargs="?", help="a sensor's name")
    parser.set_defaults(function=_show_sensors)


def _show_sensors(args: argparse.Namespace) -> Answer:
    if not args.name:
        return "\n".join(f"{e.kind:7} {e.name}" for e in catalog.entries().values()), DONE
    model = catalog.load(args.name)
    kind = kind_of(model)
    plot = kind.plot(model)
    lines = [args.name, *kind.data_sheet(model)]
    lines.append(f"source          {catalog.entries()[args.name].source}")
    return "\n".join([*lines, *(["", *plot] if plot else [])]), DONE


def add_curves_verb(verbs: Any) -> None:
    """Add ``curves``: the AP curves of whole objects by model, and where they hold."""
    parser = verbs.add_parser("curves", help="list the AP curves of whole objects, by model")
    parser.set_defaults(function=_show_curves)


def _show_curves(_: argparse.Namespace) -> Answer:
    lines = ["AP = a ln m + b, m: of an object; [ap] model = NAME, or --ap-model NAME"]
    own = {kind.name: kind.object_curves for kind in KINDS.values() if kind.curve.a > 0.0}
    for name in CURVE_MODELS:
        lines += ["", f"{name}: {curve_source(name)}"]
        rows = detectors()[name].rows if name in detectors() else {}
        for kind, curves in (fitted_curves(name) or own).items():
            for each, curve in curves.items():
                line = f"  {kind:11} {each:11}a {curve.a:6.4f}  b {curve.b:+7.4f}"
                if row := rows.get(kind, {}).get(each):
                    line += f"  RMSE {row.rmse:.3f}, m {row.m[0]:g} to {row.m[1]:g}"
                lines.append(line)
    return "\n".join(lines), DONE


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
        where = error.filename or "system"
        tell(str(InputError(where, "file", "one that can be used", reason_of(error))))
        return BAD_INPUT
