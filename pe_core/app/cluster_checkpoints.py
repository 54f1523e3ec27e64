"""Checkpoints of searches on a Dask cluster: workers send them as events, this program saves them.

Workers may be other machines, so no folder is shared. A worker posts an event to a topic of the
sweep's own; the scheduler hands the event on. An event holds what was judged since the last one.
"""

from __future__ import annotations

import queue
import secrets
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..scene import Pose
from ..search import Journal, JudgedRig
from ..study import Checkpoint, OptimizeJob, SearchState, Study, read_search
from ..sweep import SweepRun
from .extras import extra


@dataclass(frozen=True, slots=True)
class PostedCheckpoints:
    """Checkpoints that a worker posts to a topic of the scheduler.

    Attributes
    ----------
    topic, run : str
    known : tuple of JudgedRig
        The journal of an earlier part of the search.
    """

    topic: str
    run: str
    known: tuple[JudgedRig, ...] = ()

    def begin(self, job: OptimizeJob) -> Callable[[], None]:
        """Continue the search from what is known; post what is judged from then on."""
        job.journal = Journal(self.known, self.run)
        distributed = extra("distributed")
        assert distributed is not None, "a worker of Dask runs this"
        checkpoint, worker, posted = Checkpoint(job), distributed.get_worker(), len(self.known)

        def post() -> None:
            nonlocal posted
            if checkpoint.due():
                entries = job.journal.entries
                worker.log_event(self.topic, self._event(posted, entries, job.best))
                posted = len(entries)

        return post

    def _event(self, start: int, entries: tuple[JudgedRig, ...], best: Study) -> dict[str, Any]:
        poses = [[list(s.pose.position), list(s.pose.rpy)] for s in best.rig]
        judged = [list(entry) for entry in entries[start:]]
        return {"run": self.run, "start": start, "judged": judged, "best": poses}


@dataclass
class _RunSearch:
    """The search of a run as far as its events have come."""

    study: Study
    folder: Path
    entries: list[JudgedRig]
    best: Study
    meshes_saved: bool = False
    state: SearchState = field(init=False)

    def __post_init__(self) -> None:
        self.state = SearchState(self.study)

    def add(self, event: Mapping[str, Any]) -> None:
        """Add what was judged; a search that another worker began again sends the same again."""
        if event["start"] <= len(self.entries):
            new = [JudgedRig(float(e), bool(b), str(m)) for e, b, m in event["judged"]]
            self.entries[event["start"] : event["start"] + len(new)] = new
            poses = [Pose(tuple(at), tuple(rpy)) for at, rpy in event["best"]]
            self.best = self.study.with_rig(self.study.rig.with_poses(poses))

    def save(self) -> None:
        """Write the checkpoint into the run's folder."""
        with suppress(InputError):  # the search goes on; its results are written elsewhere
            self.state.save(self.folder, self.best, self.entries, meshes=not self.meshes_saved)
            self.meshes_saved = True


class ClusterCheckpoints:
    """Receives and saves the checkpoints of all runs of a sweep.

    Parameters
    ----------
    client : distributed.Client
    """

    def __init__(self, client: Any) -> None:
        self._topic = f"perception-entropy-{secrets.token_hex(8)}"
        self._events: queue.SimpleQueue[Mapping[str, Any]] = queue.SimpleQueue()
        self._searches: dict[str, _RunSearch] = {}
        client.subscribe_topic(self._topic, self._receive)

    def for_run(self, run: SweepRun, folder: Path) -> PostedCheckpoints:
        """Return the checkpoints of a run; they begin with those in its folder."""
        search = self._searches.get(run.name)
        if search is None:
            search = _RunSearch(run.study, folder, _entries_in(folder, run.study), run.study)
            self._searches[run.name] = search
        return PostedCheckpoints(self._topic, run.name, tuple(search.entries))

    def save(self) -> None:
        """Save what has come since the last time."""
        changed = {}
        with suppress(queue.Empty):
            while True:
                event = self._events.get_nowait()
                search = changed[event["run"]] = self._searches[event["run"]]
                search.add(event)
        for search in changed.values():
            search.save()

    def _receive(self, event: tuple[float, Mapping[str, Any]]) -> None:
        """Take an event, in the client's own thread."""
        self._events.put(event[1])


def _entries_in(folder: Path, study: Study) -> list[JudgedRig]:
    """Return the journal in a run's folder; none where there is none, or that of another study."""
    try:
        return list(read_search(folder).journal_of(study).entries)
    except InputError:
        return []
