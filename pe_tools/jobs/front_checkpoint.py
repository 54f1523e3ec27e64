"""The checkpoint of a front: the journals of all its searches, from which it resumes.

A search that resumes from its journal asks for the same placements and takes their values from it.
So a front that was interrupted ends at the same bits as one that was not.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.files import read_bytes
from pe_core.base.serialization import load_toml, parse_json
from pe_core.search import EvaluatedRig, Journal
from pe_core.study.file_names import SEARCH, STUDY
from pe_core.study.study import Study
from pe_core.study.study_file import study_from_dict
from pe_core.version import __version__

from .checkpoint import PROGRAM, STATE_BYTES, state_head
from .folder import FileSet, prepare_folder
from .study_export import fingerprint, study_writers

FRONT_SEARCH = "front_search.json"
KIND = "front search"
A_STATE = "the checkpoint of a front, as this program writes it"


class FrontJournals:
    """The journals of several searches, by the name of each.

    Parameters
    ----------
    known : mapping of str to iterable of EvaluatedRig
        Of an interrupted run.
    """

    def __init__(self, known: Mapping[str, Iterable[EvaluatedRig]] | None = None) -> None:
        self._known = {name: tuple(entries) for name, entries in (known or {}).items()}
        self._journals: dict[str, Journal] = {}

    def begin(self, name: str) -> Journal:
        """Return the journal of a search that begins; it continues a known one."""
        self._journals[name] = Journal(self._known.get(name, ()), FRONT_SEARCH)
        return self._journals[name]

    @property
    def count(self) -> int:
        """Number of entries so far, those of searches that have not begun again included."""
        return sum(map(len, self.entries().values()))

    def entries(self) -> dict[str, tuple[EvaluatedRig, ...]]:
        """Return all entries by search; may be read while another thread searches."""
        return self._known | {name: each.entries for name, each in self._journals.items()}


class FrontCheckpoint:
    """The checkpoint of a front, which is saved in its folder while the search runs.

    Parameters
    ----------
    study : Study
        The study whose front is computed.
    """

    def __init__(self, study: Study) -> None:
        self._study = study
        self._folder: Path | None = None

    @cached_property
    def _head(self) -> dict[str, Any]:
        """The constant part: cached, because it is expensive for a large mesh."""
        return state_head(KIND, self._study)

    def save(self, journals: FrontJournals, folder: Path) -> None:
        """Write the checkpoint into the front's folder; once also the files that the study names.

        Raises
        ------
        InputError
            The folder cannot be written, or another program wrote such a file in it.
        """
        state = {**self._head, "journals": journals.entries()}
        with FileSet(prepare_folder(folder, (FRONT_SEARCH,))) as files:
            if folder != self._folder:
                for name, write in study_writers(self._study, STUDY).items():
                    if name != STUDY:
                        files.add(name, write)
            files.add(FRONT_SEARCH, json.dumps(state, ensure_ascii=False).encode())
        self._folder = folder


def front_study(folder: str | Path) -> Study | None:
    """Return the study of a front's checkpoint; None for a folder with the state of one search.

    Raises
    ------
    InputError
        The checkpoint is damaged, or files that the study names have changed.
    """
    path = Path(folder) / FRONT_SEARCH
    if (Path(folder) / SEARCH).exists() or not path.exists():
        return None
    data = _read(path)
    study = study_from_dict(load_toml(path, "study", data["study"]), str(path), path.parent)
    if fingerprint(study) != data["study_sha256"]:
        raise InputError(path, "study", "unchanged files beside the study", "changed files")
    return study


def read_front_search(study: Study, folder: Path) -> FrontJournals:
    """Read the checkpoint of a front of a study.

    Raises
    ------
    InputError
        There is none, it is damaged or of another version, or it belongs to another study.
    """
    path = folder / FRONT_SEARCH
    data = _read(path)
    if data["study_sha256"] != fingerprint(study):
        expected = "the study and the options that it was begun with"
        raise InputError(path, "study", expected, "others")
    return FrontJournals(data["journals"])


def _read(path: Path) -> dict[str, Any]:
    """Return the data of a checkpoint of this version, journals as entries."""
    try:
        data: Any = parse_json(path, read_bytes(path, STATE_BYTES), infinite=True)
        if data[PROGRAM] != KIND:
            raise ValueError
        read = {key: str(data[key]) for key in ("version", "study_sha256", "study")}
        journals = {
            str(name): [EvaluatedRig(float(e), bool(b), str(d)) for e, b, d in rows]
            for name, rows in data["journals"].items()
        }
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(path, "file", A_STATE, "another file") from None
    if read["version"] != __version__:
        expected = f"{__version__}, the version of this program"
        raise InputError(path, "version", expected, shown(read["version"]))
    return {**read, "journals": journals}
