"""The state of a search, in the folder of its results: it goes on from there after any end.

It is the study as it was given, and the journal of what the search was told. Beside it are the best
placement so far, as a study, and the meshes and boxes that both need.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from ..errors import InputError, shown
from ..search import Journal, JudgedRig
from ..text.files import read_bytes
from ..text.toml_reader import load_toml
from ..version import __version__
from .exporting import study_writers
from .fingerprint import fingerprint
from .folder import FileSet, prepare_folder
from .inputs import inputs_of
from .names import SEARCH, STUDY
from .study import Study
from .study_file import study_from_dict

PROGRAM, KIND = "perception-entropy", "search"
STATE_BYTES = 1 << 30
"""The greatest state: of about thirty million judged placements."""
KEYS = ("version", "inputs", "study", "study_sha256", "judged")
A_STATE = "the state of a search, as this program writes it"


class SearchState:
    """What a search of a study leaves in its folder while it runs.

    Parameters
    ----------
    study : Study
        As it was given.
    inputs : dict, optional
        What the search was given at its beginning, where files were called otherwise then.
    """

    def __init__(self, study: Study, inputs: dict[str, Any] | None = None) -> None:
        self._study, self._inputs = study, inputs

    @cached_property
    def _head(self) -> dict[str, Any]:
        """All but what was judged: it is the same each time, and dear for a large mesh."""
        written = study_writers(self._study, STUDY)[STUDY]
        assert isinstance(written, bytes)
        return {
            PROGRAM: KIND,
            "version": __version__,
            "study_sha256": fingerprint(self._study),
            "inputs": self._inputs or inputs_of(self._study),
            "study": written.decode(),
        }

    def to_bytes(self, entries: Iterable[JudgedRig]) -> bytes:
        """Return the text of the file."""
        return json.dumps({**self._head, "judged": list(entries)}, ensure_ascii=False).encode()

    def save(
        self, folder: Path, best: Study, entries: Iterable[JudgedRig], *, meshes: bool = True
    ) -> None:
        """Put state and best placement into a folder; without `meshes`, these are there already.

        Raises
        ------
        InputError
            The folder cannot be written, or a file in it is somebody else's: all stays as it was.
        """
        with FileSet(prepare_folder(folder)) as files:
            for name, write in study_writers(best, STUDY).items():
                if meshes or name == STUDY:
                    files.add(name, write)
            files.add(SEARCH, self.to_bytes(entries))


@dataclass(frozen=True, slots=True)
class BegunSearch:
    """A search that was begun: its study as it was given, and what it was told so far.

    `study` calls meshes and boxes as they are called in the folder, `inputs` as at the beginning.
    """

    path: Path
    study: Study
    inputs: dict[str, Any]
    judged: tuple[JudgedRig, ...]

    def journal_of(self, study: Study) -> Journal:
        """Return the journal, for a search of a study to go on with.

        Raises
        ------
        InputError
            When the search was not of this study.
        """
        if fingerprint(study) != fingerprint(self.study):
            expected = "the study and the options that it was begun with"
            raise InputError(self.path, "study", expected, "others")
        return Journal(self.judged, str(self.path))


def read_search(folder: str | Path) -> BegunSearch:
    """Read the state of a search from the folder of its results.

    Raises
    ------
    InputError
        There is none, it is damaged or of another version, or a mesh or boxes beside it are not
        those it was begun with.
    """
    path = Path(folder) / SEARCH
    data = _data_of(path)
    if data["version"] != __version__:
        expected = f"{__version__}, the version of this program"
        raise InputError(path, "version", expected, shown(data["version"]))
    entries = _entries_of(path, data["judged"])
    study = study_from_dict(load_toml(path, "study", data["study"]), str(path), path.parent)
    if fingerprint(study) != data["study_sha256"]:
        raise InputError(path, "study", "the files beside it as they were", "that they changed")
    return BegunSearch(path, study, data["inputs"], entries)


def _data_of(path: Path) -> dict[str, Any]:
    try:
        data: Any = json.loads(read_bytes(path, STATE_BYTES))
        typed = isinstance(data["study"], str) and isinstance(data["inputs"], dict)
        if data[PROGRAM] == KIND and typed:
            return {key: data[key] for key in KEYS}
    except (KeyError, RecursionError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
    raise InputError(path, "file", A_STATE, "another file")


def _entries_of(path: Path, rows: Any) -> tuple[JudgedRig, ...]:
    rows = rows if isinstance(rows, list) else [rows]
    for number, row in enumerate(rows):
        kinds = [type(value) for value in row] if isinstance(row, list) else []
        if kinds != [float, bool, str]:
            raise InputError(path, f"judged[{number}]", "an entropy, a truth, a mark", shown(row))
    return tuple(JudgedRig(*row) for row in rows)
