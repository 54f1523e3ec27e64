"""The command ``pe``: a row for each of its verbs. Blender's command has the same rows, with the
open scene as the source of studies."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial, reduce
from operator import or_
from typing import TYPE_CHECKING, Any, NamedTuple

from pe_core.base.errors import InputError
from pe_core.base.lazy_threads import threads
from pe_core.base.plugins import call_plugin, find_plugins, load_plugin, plugin_name

from ..versions import versions_text
from .command import Parser, as_typed, run
from .description import described
from .options import add_options
from .study_source import FILE, FILES, NONE, ONE, PERHAPS, SOME, StudyFiles
from .terminal import EXIT_STATUSES, Answer, open_missing_streams, tell

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

VerbFunction = Callable[[Any, argparse.Namespace], Answer]
"""Of where studies come from (`StudyFiles`, a scene's) and the arguments."""
BEGIN = "begin"
SCORE = "score"
PLACE = "place"
SHOW = "show"
MORE = "more"
"""Groups of verbs in the help; verbs of plugins are in the last one."""
COMMON = "set samples condition"
SEARCH = "evaluations seed method"


class Verb(NamedTuple):
    """A verb: its name, its group in the help, its meaning; what it takes (`study_source`), the
    names of its rows in `options`, beside ``--json``, what it does, and the types of what it prints
    as JSON. `function` and `prints` may be names on the face of this room: a verb loads its own."""

    name: str
    group: str
    about: str
    takes: str
    options: str
    function: str | VerbFunction
    prints: Any

    @property
    def answer(self) -> Any:
        """The type of what it prints with ``--json``."""
        if isinstance(self.prints, str):
            return reduce(or_, map(_on_face, self.prints.split()))
        return self.prints

    def call(self, source: StudyFiles, args: argparse.Namespace) -> Answer:
        """Return what the verb answers."""
        work = _on_face(self.function) if isinstance(self.function, str) else self.function
        found: Answer = work(source, args)
        return found

    def add(self, verbs: Any, source: StudyFiles, *, is_asked: bool = True) -> Parser:
        """Add the verb to the parser of a command; return its own parser. One that is not asked for
        has no arguments."""
        parser: Parser = verbs.add_parser(self.name, help=self.about)
        if not is_asked:
            return parser
        source.add_arguments(parser, self.takes)
        add_options(parser, f"{self.options} json")
        parser.set_defaults(
            function=self.call, kind=self.name, source=source, usage_error=parser.error
        )
        return parser


def _on_face(name: str) -> Any:
    """Return what a name on the face of this room is of; it is loaded now."""
    return getattr(sys.modules[__package__], name)


class _InGroups(argparse.HelpFormatter):
    """Help with the verbs in groups."""

    def _iter_indented_subactions(self, action: argparse.Action) -> Any:
        verbs = {verb.dest: verb for verb in getattr(action, "_choices_actions", ())}
        groups = {verb.name: verb.group for verb in VERBS}
        for group in dict.fromkeys([*groups.values(), MORE]):
            if found := [verb for name, verb in verbs.items() if groups.get(name, MORE) == group]:
                yield argparse.Action([], "", metavar=group)
                self._indent()
                yield from found
                self._dedent()


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status (`terminal.EXIT_STATUSES`)."""
    open_missing_streams()
    threads().keep_freed_memory()
    given = sys.argv[1:] if argv is None else argv
    return run(lambda: answer(parser(given).parse_args(given), "pe", given))


def answer(args: argparse.Namespace, prog: str, argv: Sequence[str]) -> Answer:
    """Return what the verb of a parsed command line answers."""
    args.command_line = as_typed(prog, argv)
    found: Answer
    if not hasattr(args, "source"):  # a verb of a plugin
        found = args.function(args)
        return found
    with args.source.naming(args):
        found = args.function(args.source, args)
    return found


def parser(argv: Sequence[str] = ()) -> argparse.ArgumentParser:
    """Return the parser of ``pe``, as `command_parser` does."""
    top, verbs = command_parser("pe", versions_text(), VERBS, StudyFiles(), argv=argv)
    is_own = bool(_asked(VERBS, argv))
    for plugin in () if is_own else find_plugins("verb"):
        _add_plugin_verbs(plugin, verbs)
    return top


def command_parser(
    prog: str, version: str, rows: Sequence[Verb], source: StudyFiles, argv: Sequence[str] = ()
) -> tuple[argparse.ArgumentParser, Any]:
    """Return the parser of a command with these verbs, and its action that takes further ones.

    Parameters
    ----------
    argv : sequence of str, optional
        The command line, if it is known: where it begins with a verb, no other verb has arguments.
    """
    statuses = "; ".join(f"{number} {meaning}" for number, meaning in EXIT_STATUSES.items())
    top = Parser(
        prog=prog,
        description="Perception entropy of vehicle sensors.",
        formatter_class=_InGroups,
        epilog=f"Exit status: {statuses}. Manual: docs/index.md of the source.",
    )
    top.add_argument("--version", action="version", version=version)
    top.set_defaults(rows=rows)  # a session has some of them
    verbs = top.add_subparsers(required=True, metavar="VERB")
    asked = _asked(rows, argv) or rows
    parsers = [(verb, verb.add(verbs, source, is_asked=verb in asked)) for verb in rows]
    for pair in parsers:
        pair[1].described = partial(described, prog, version, [pair])
    top.described = partial(described, prog, version, parsers)
    return top, verbs


def _asked(rows: Sequence[Verb], argv: Sequence[str]) -> list[Verb]:
    """Return the verb that a command line begins with; none where it begins with another word."""
    return [verb for verb in rows if list(argv[:1]) == [verb.name]]


def _add_plugin_verbs(point: EntryPoint, verbs: Any) -> None:
    """Add the verbs of a plugin, a function that takes the parser's verbs. A plugin that fails is
    reported by name; all other verbs work."""
    try:
        call_plugin(point, load_plugin(point), verbs)
    except ImportError as error:
        found = " ".join(str(error).split())
        tell(
            f"{plugin_name(point)}: expected what it imports, found {found}; its verbs are missing"
        )
    except InputError as error:
        tell(f"{error}; its verbs are missing")


VERBS = (
    Verb(
        "new",
        BEGIN,
        "write a first study of a vehicle's mesh, or of a known rig",
        NONE,
        options="mesh_file rig placement set_found study_file replace",
        function="new",
        prints="FilesAnswer RigsAnswer",
    ),
    Verb(
        "set",
        BEGIN,
        "change keys of a study file; its comments stay",
        FILE,
        options="changes",
        function="set_keys",
        prints="KeysAnswer",
    ),
    Verb(
        "import",
        BEGIN,
        "make a study of another program's rig",
        NONE,
        options="foreign_file from models origin mesh rear_axle study_file replace",
        function="import_study",
        prints="FilesAnswer",
    ),
    Verb(
        "sensors",
        BEGIN,
        "list the catalogue, or show one sensor",
        NONE,
        options="sensor_name curves",
        function="show_sensors",
        prints="CatalogAnswer SensorAnswer CurvesAnswer",
    ),
    Verb(
        "score",
        SCORE,
        "score a study's rig",
        ONE,
        options=f"{COMMON} figures workers folder",
        function="run_study",
        prints="ResultRecord",
    ),
    Verb(
        "explain",
        SCORE,
        "a study's score in words, one place of it, or the steepest way of a sensor",
        ONE,
        options=f"at body heading suggest class of_sensor measured_from {COMMON} workers",
        function="explain",
        prints="ExplainAnswer",
    ),
    Verb(
        "check",
        SCORE,
        "hold a study to its requirements; 3: some are not met",
        PERHAPS,
        options="preset scenarios list suggest set file replace",
        function="check",
        prints="CheckAnswer PresetsAnswer",
    ),
    Verb(
        "compare",
        SCORE,
        "score several studies and put them side by side, or a built rig and its design",
        SOME,
        options=f"beside built from rear_axle origin {COMMON} figures workers",
        function="compare_all",
        prints="CompareAnswer BuiltAnswer",
    ),
    Verb(
        "where",
        PLACE,
        "score one more sensor all over the vehicle's surface",
        ONE,
        options="model of_part|mount figure places set workers file replace",
        function="where",
        prints="WhereAnswer",
    ),
    Verb(
        "region",
        PLACE,
        "tell where a sensor may go while a figure loses little",
        ONE,
        options="sensor figure loss others places set snap workers region_file replace",
        function="region",
        prints="RegionAnswer",
    ),
    Verb(
        "optimize",
        PLACE,
        "search for a better placement",
        PERHAPS,
        options=f"{COMMON} figures {SEARCH} start snap workers executor folder|resume no_review",
        function="run_study",
        prints="ResultRecord FrontRecord",
    ),
    Verb(
        "sweep",
        PLACE,
        "run many studies, or one with many changes",
        FILES,
        options="try samples figures condition evaluations seed method optimize part workers "
        "executor required_folder",
        function="sweep",
        prints="SweepAnswer",
    ),
    Verb(
        "review",
        SHOW,
        "write an HTML page that shows a rig and what its sensors see",
        SOME,
        options=f"title author date revision regions built from rear_axle origin {COMMON} figures "
        "workers required_folder replace",
        function="review",
        prints="FilesAnswer",
    ),
    Verb(
        "export",
        SHOW,
        "write a rig or scene for another program, or a copy",
        ONE,
        options="to range origin rear_axle set path into replace",
        function="export",
        prints="FilesAnswer",
    ),
    Verb(
        "serve",
        SHOW,
        "answer requests of another program: JSON lines on standard input and output",
        NONE,
        options="",
        function="serve",
        prints="ServeReply",
    ),
    Verb(
        "verify",
        MORE,
        "hold the engine as it is installed to its golden cases; 3: some fail",
        NONE,
        options="folder",
        function="verify",
        prints="VerifyAnswer",
    ),
)
