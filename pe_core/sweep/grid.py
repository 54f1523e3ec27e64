"""The runs of a sweep: every study with every combination of changes."""

from __future__ import annotations

import copy
import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import InputError, shown
from ..scene import Vehicle
from ..study import Study, load_study_data, study_from_dict
from .names import folder_names
from .run import SweepRun
from .settings import SOURCE, TriedKey

MOST_RUNS = 10_000
"""A sweep of more runs is taken for a slip of the pen."""
Made = dict[str, str]


def sweep_runs(
    files: Mapping[str, str | Path],
    settings: Sequence[TriedKey],
    options: Callable[[Study], Study] = lambda study: study,
) -> list[SweepRun]:
    """Return the runs of study files by name, each with each combination of the settings' values.

    Parameters
    ----------
    files : mapping of str to path
    settings : sequence of TriedKey
    options : callable, optional
        Made every study on top.

    Raises
    ------
    InputError
        A file is no study, a key or a value fits none, or there are more than `MOST_RUNS` runs.
    """
    count = len(files) * math.prod(len(setting.values) for setting in settings)
    if count > MOST_RUNS:
        raise InputError(SOURCE, "runs", f"at most {MOST_RUNS:,}", f"{count:,}")
    made = [
        (name, changes, options(study))
        for name, path in files.items()
        for changes, study in _changed_studies(Path(path), settings)
    ]
    names = folder_names([(name, changes) for name, changes, _ in made])
    return [
        SweepRun(folder, name, changes, study)
        for folder, (name, changes, study) in zip(names, made, strict=True)
    ]


def _changed_studies(path: Path, settings: Sequence[TriedKey]) -> Iterator[tuple[Made, Study]]:
    data, vehicles = load_study_data(path), dict[str, Vehicle | None]()
    choices = [range(len(setting.values)) for setting in settings]
    for numbers in itertools.product(*choices):
        changed, changes = copy.deepcopy(data), Made()
        for setting, number in zip(settings, numbers, strict=True):
            _set(changed, setting, setting.values[number], str(path))
            changes[setting.key] = setting.texts[number]
        study = _study(changed, path, changes)
        vehicle = vehicles.setdefault(repr(changed.get("vehicle")), study.vehicle)  # kept once
        yield changes, replace(study, vehicle=vehicle)


def _study(data: dict[str, Any], path: Path, changes: Made) -> Study:
    """Build a study; a message of what is wrong in it tells what was changed."""
    try:
        return study_from_dict(data, str(path), path.parent)
    except InputError as error:
        if not changes or error.source != str(path):
            raise
        told = ", ".join(f"{key}={text}" for key, text in changes.items())
        raise error.at(f"{path} with {told}") from None


def _set(data: dict[str, Any], setting: TriedKey, value: Any, source: str) -> None:
    """Change a value in a study's plain data; tables on the way to it are made."""
    *path, last = setting.path
    here: Any = data
    for number, part in enumerate(path):
        found = ".".join(setting.path[:number]) or "document"
        here = _inside(here, part, setting, source, found)
    if isinstance(here, list):
        here[_index(here, last, setting, source)] = copy.deepcopy(value)
    elif isinstance(here, dict):
        here[last] = copy.deepcopy(value)
    else:
        raise InputError(source, setting.key, "a table before the last dot", shown(here))


def _inside(here: Any, part: str, setting: TriedKey, source: str, found: str) -> Any:
    if isinstance(here, list):
        return here[_index(here, part, setting, source)]
    if isinstance(here, dict):
        return here.setdefault(part, {})
    raise InputError(source, setting.key, f"a table at {found}", shown(here))


def _index(elements: list[Any], part: str, setting: TriedKey, source: str) -> int:
    """Return the place of a list's element, of its name or number."""
    names = [each.get("name") if isinstance(each, dict) else None for each in elements]
    if part in names:
        return names.index(part)
    if part.isdecimal() and int(part) < len(elements):
        return int(part)
    known = [str(name) for name in names if name is not None] or [f"0 to {len(elements) - 1}"]
    raise InputError(source, setting.key, f"one of {', '.join(known)}", shown(part))
