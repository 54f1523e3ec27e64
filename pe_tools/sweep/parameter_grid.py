"""The runs of a sweep: every study with every combination of changes, and their folders' names."""

import hashlib
import itertools
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pe_core.base.errors import InputError
from pe_core.scene import Vehicle
from pe_core.study import Study, load_study_data

from .study_changes import MAX_RUNS, SOURCE, KeyChange, changed_study
from .sweep_runner import SweepRun

UNSAFE = re.compile(r"[^A-Za-z0-9._=+-]+")
MAX_NAME_LENGTH = 100  # Characters of a name; a longer one is cut and gets a hash
HASH_BYTES = 4


def folder_names(runs: Sequence[tuple[str, Mapping[str, str]]]) -> list[str]:
    """Return a folder name for each run: study and changes, ``car,sensor.roof.model=Pandar64``.
    Characters that are not allowed in names become hyphens. Such names, long names, and names that
    differ only in case end in a hash of study and changes."""
    words = [(name, *(f"{key}={text}" for key, text in changes.items())) for name, changes in runs]
    plain = [",".join(UNSAFE.sub("-", word) for word in each) for each in words]
    alike = Counter(name.casefold() for name in plain)
    names = []
    for name, each in zip(plain, words, strict=True):
        short = name[:MAX_NAME_LENGTH].strip("-.") or "run"
        if short != ",".join(each) or alike[name.casefold()] > 1:
            content = "\0".join(each).encode("utf-8", "surrogatepass")
            digest = hashlib.blake2b(content, digest_size=HASH_BYTES).hexdigest()
            short = f"{short}-{digest}"
        names.append(short)
    return names


def sweep_runs(
    files: Mapping[str, str | Path],
    tried: Sequence[Sequence[KeyChange]],
    options: Callable[[Study], Study] = lambda study: study,
) -> list[SweepRun]:
    """Return the runs of study files by name, each with each combination of the changes that are
    tried. `options` are applied to every study after the changes. `InputError` for a file that is
    no study, a key or a value that does not fit it, or more than `MAX_RUNS` runs."""
    count = len(files) * math.prod(map(len, tried))
    if count > MAX_RUNS:
        raise InputError(SOURCE, "runs", f"at most {MAX_RUNS:,}", f"{count:,}")
    made = [
        (name, changes, options(study))
        for name, path in files.items()
        for changes, study in _changed_studies(Path(path), tried)
    ]
    names = folder_names([(name, changes) for name, changes, _ in made])
    return [
        SweepRun(folder, name, changes, study)
        for folder, (name, changes, study) in zip(names, made, strict=True)
    ]


def _changed_studies(
    path: Path, tried: Sequence[Sequence[KeyChange]]
) -> Iterator[tuple[dict[str, str], Study]]:
    data = load_study_data(path)
    vehicles: dict[str, Vehicle | None] = {}
    for changes in itertools.product(*tried):
        texts = {change.key: change.text for change in changes}
        try:
            study = changed_study(data, changes, str(path), path.parent)
        except InputError as error:
            if not changes or error.source != str(path):
                raise
            named = ", ".join(f"{key}={text}" for key, text in texts.items())
            raise error.at(f"{path} with {named}") from None
        of_vehicle = repr([c.text for c in changes if c.path[0] == "vehicle"])
        vehicle = vehicles.setdefault(of_vehicle, study.vehicle)  # kept once
        yield texts, replace(study, vehicle=vehicle)
