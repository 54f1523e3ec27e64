"""Where a command line's studies come from: from files, or in Blender from the open scene."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TextIO

from pe_core.base.errors import InputError, require_name, shown
from pe_core.base.files import read_bytes
from pe_core.base.input_files import not_noting_inputs
from pe_core.base.table_reader import parse_json
from pe_core.search.goals import Start
from pe_core.study import RESULT, STUDY, StateInWeather, Study, load_study, load_study_data

from .. import jobs
from ..advice import Advice
from ..known_defects import fixed_since
from ..sweep import KeyChange, changed_study, read_changes
from .run_job import More
from .terminal import tell

NONE = ""
ONE = "one"
PERHAPS = "perhaps"
SOME = "some"
FILE = "file"
FILES = "files"
"""What a verb takes: nothing; a study of the source, one that may be missing, or several; a study
file, or several, whatever the source is."""
OF_STUDY = "study"
OF_REQUIREMENT = "requirement "
"""Source of an error that names no file, and the beginning of another."""
VEHICLE = "vehicle"
OF_MESH = ("mesh", "axes", "faces", "mesh_notes")
"""Fields of a study: its vehicle, and how the mesh of that was read."""
BETWEEN = ", "  # State and weather of a condition


class StudyFiles:
    """Studies by their files, the source of the command ``pe``."""

    versions: dict[str, str] | None = None
    """Versions of the program around the engine."""
    out: TextIO | None = None
    """Where the replies of a session go; None: to stdout."""

    def add_arguments(self, verb: argparse.ArgumentParser, takes: str) -> None:
        """Add what names the studies to the parser of a verb."""
        about = "study file (TOML)"
        if takes in (ONE, PERHAPS, FILE):
            count = "?" if takes == PERHAPS else None
            verb.add_argument("study", nargs=count, metavar="STUDY", help=about)
        elif takes in (SOME, FILES):
            verb.add_argument("studies", nargs="+", metavar="STUDY", help=about)

    def study(self, args: argparse.Namespace) -> Study:
        """Return the study of a command line, with the changes of its options. A search that is
        resumed has its own."""
        changes = read_changes(args.set)
        if args.study is not None:
            return self._read(args.study, changes, args)
        if getattr(args, "resume", None) is None:
            args.usage_error("expected STUDY")
        return self.changed(jobs.read_search(args.resume).study, args, args.resume)

    def studies(self, args: argparse.Namespace) -> dict[str, Study]:
        """Return the studies of a command line by name, with the changes of its options."""
        changes = read_changes(args.set)
        files = named_by_file(args.studies)
        return {name: self._read(path, changes, args) for name, path in files.items()}

    def _read(self, path: str, changes: Sequence[KeyChange], args: argparse.Namespace) -> Study:
        data = load_study_data(Path(path))
        anywhere = getattr(args, "snap", False)
        folder = Path(path).parent
        tell_fixed_defects(folder)
        study = changed_study(data, changes, path, folder, starts_anywhere=anywhere)
        with naming_study(path):
            return with_options(study, args)

    @contextmanager
    def naming(self, args: argparse.Namespace) -> Iterator[None]:
        """Have errors of the study name its file, within."""
        with naming_study(getattr(args, "study", None)):
            yield

    def opened(self) -> Study:
        """Return the study that a session begins with; `InputError` where there is none."""
        expected = 'one that was loaded: {"do": "load", "study": "study.toml"}'
        raise InputError("session", "study", expected, "none")

    def changed(self, study: Study, args: argparse.Namespace, source: str) -> Study:
        """Return a study in memory with the changes of a command line; errors name the source."""
        return with_options(with_changes(study, read_changes(args.set), source), args)

    def artifacts(self, study: Study, *, searches: bool) -> Sequence[More]:
        """Return further files of a run; `InputError` where a result could not be kept."""
        return ()

    def notes(self) -> tuple[Advice, ...]:
        """Return warnings about the source."""
        return ()

    def stored_result(self, study: Study, args: argparse.Namespace) -> Mapping[str, Any] | None:
        """Return the result beside the study's file; None where it is not of this study."""
        path = getattr(args, "study", None)
        return None if path is None else jobs.stored_result(Path(path).parent, study)

    def share_evaluators(self, job: jobs.Job) -> None:
        """Give a job the evaluators of earlier ones: none here, a command has one job."""


@not_noting_inputs()
def tell_fixed_defects(folder: Path) -> None:
    """Print which defects the result in a study's folder may have that were fixed since."""
    path = folder / RESULT
    if path.is_file():
        with suppress(InputError):  # another program's file of that name
            data = parse_json(path, read_bytes(path))
            for line in fixed_since(data if isinstance(data, dict) else {}):
                tell(f"{path}: {line}")


def with_options(study: Study, args: argparse.Namespace) -> Study:
    """Return a study with the changes of the options that are no keys of it."""
    if (name := getattr(args, "condition", None)) is not None:
        study = study.under(_condition(study, name))
    if getattr(args, "snap", False):
        study = _on_mounts(study)
    rigs = [(Path(path).stem, load_study(path).rig) for path in getattr(args, "start", ())]
    if not rigs:
        return study
    starts = [Start(name, {s.name: s.pose for s in rig}) for name, rig in rigs]
    goals = replace(study.search.goals, starts=(*study.search.goals.starts, *starts))
    changed = replace(study, search=replace(study.search, goals=goals))
    changed.coding()  # a start that does not fit is bad input, not a late surprise
    return changed


@contextmanager
def naming_study(path: str | None) -> Iterator[None]:
    """Have errors of a study name its file, within."""
    try:
        yield
    except InputError as error:
        if path is None:
            raise
        if error.source == OF_STUDY:
            raise error.at(path) from None
        if error.source.startswith(OF_REQUIREMENT):
            raise error.within(path) from None
        raise


def with_changes(study: Study, changes: Sequence[KeyChange], source: str) -> Study:
    """Return a study that is in memory with changes of its keys: it is written and read again.
    The vehicle, and how its mesh was read, stay unless a key of [vehicle] is changed."""
    if not changes:
        return study
    vehicle = study.vehicle
    if any(change.path[0] == VEHICLE for change in changes):
        vehicle = None
    with TemporaryDirectory() as name, not_noting_inputs():
        folder = Path(name)
        jobs.export_study(study, folder / STUDY, with_mesh=vehicle is None)
        data = load_study_data(folder / STUDY)
        changed = changed_study(
            data, changes, source, folder, starts_anywhere=True, vehicle=vehicle
        )
    if vehicle is None:
        return changed
    kept = {field: getattr(study, field) for field in (VEHICLE, *OF_MESH)}
    return replace(changed, **kept)


def _condition(study: Study, text: str) -> StateInWeather:
    """Return the condition of the names of a state, a weather, or both; `InputError` for others."""
    conditions = study.conditions
    states = [each.name for each in conditions.states]
    weathers = [each.name for each in conditions.weathers]
    chosen: dict[str, str] = {}
    for name in [text] if text in (*states, *weathers) else text.split(BETWEEN):
        if not (states or weathers):
            raise InputError(OF_STUDY, "condition", "[[state]] or [[weather]] in it", shown(name))
        require_name(OF_STUDY, "condition", name, [*states, *weathers])
        chosen["state" if name in states else "weather"] = name
    return conditions.one(**chosen)


def _on_mounts(study: Study) -> Study:
    """Return a study with its sensors on their mounts; those that moved are printed."""
    placed = study.on_mounts()
    for sensor in placed.rig:
        if sensor.pose != study.rig[sensor.name].pose:
            at = ", ".join(f"{value:g}" for value in sensor.pose.position)
            told = "".join(f", {each}" for each in placed.distances(sensor))
            tell(f"{sensor.name}: put on its mount, at ({at}) m{told}")
    return placed


def named_by_file(paths: Sequence[str]) -> dict[str, str]:
    """Return study files by short, different names: the file's, with its folder's if needed."""
    for depth in (1, 2):
        names = ["/".join((*Path(p).parts[:-1], Path(p).stem)[-depth:]) for p in paths]
        if len(set(names)) == len(names):
            return dict(zip(names, paths, strict=True))
    return dict(zip(paths, paths, strict=False))
