"""The checkpoint of a front: the journals of all its searches, from which it resumes.

A search that resumes from its journal asks for the same placements and takes their values from it.
So a front that was interrupted ends at the same bits as one that was not.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from pe_core.base.errors import InputError, shown
from pe_core.base.files import read_bytes
from pe_core.base.serialization import parse_json
from pe_core.search import EvaluatedRig, Journal
from pe_core.study.study import Study
from pe_core.version import __version__

from .folder import FileSet, prepare_folder
from .study_export import fingerprint

FRONT_SEARCH = "front_search.json"
PROGRAM, KIND = "perception-entropy", "front search"
STATE_BYTES = 1 << 30
"""Maximum size of a checkpoint."""
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


def save_front_search(study: Study, journals: FrontJournals, folder: Path) -> None:
    """Write the checkpoint of a front into its folder.

    Raises
    ------
    InputError
        The folder cannot be written, or another program wrote such a file in it.
    """
    state = {
        PROGRAM: KIND,
        "version": __version__,
        "study_sha256": fingerprint(study),
        "journals": journals.entries(),
    }
    with FileSet(prepare_folder(folder, (FRONT_SEARCH,))) as files:
        files.add(FRONT_SEARCH, json.dumps(state, ensure_ascii=False).encode())


def read_front_search(study: Study, folder: Path) -> FrontJournals:
    """Read the checkpoint of a front of a study.

    Raises
    ------
    InputError
        There is none, it is damaged or of another version, or it belongs to another study.
    """
    path = folder / FRONT_SEARCH
    try:
        data: Any = parse_json(path, read_bytes(path, STATE_BYTES), infinite=True)
        if data[PROGRAM] != KIND:
            raise ValueError
        version, digest = str(data["version"]), str(data["study_sha256"])
        known = {
            str(name): [EvaluatedRig(float(e), bool(b), str(d)) for e, b, d in rows]
            for name, rows in data["journals"].items()
        }
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(path, "file", A_STATE, "another file") from None
    if version != __version__:
        expected = f"{__version__}, the version of this program"
        raise InputError(path, "version", expected, shown(version))
    if digest != fingerprint(study):
        expected = "the study and the options that it was begun with"
        raise InputError(path, "study", expected, "others")
    return FrontJournals(known)
