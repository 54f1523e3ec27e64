"""Candidates judged together, here or by the workers of any executor, with the same result."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from typing import Protocol, runtime_checkable

from ..scene.sensors import Rig
from .handing_out import Assignment, Reply, Unreadable, handed_out
from .objective import Judgement, Objective
from .parcels import NotHere, Parcel, contents, packed, unpacked


@runtime_checkable
class OfItself(Protocol):
    """An objective that sees to several rigs itself: it knows some of them, say."""

    def judge_all(
        self, rigs: Sequence[Rig], below: float, executor: Executor | None
    ) -> list[Judgement]:
        """As the function of this name."""


def judge_all(
    objective: Objective,
    rigs: Sequence[Rig],
    below: float = math.inf,
    executor: Executor | None = None,
) -> list[Judgement]:
    """Judge several rigs; what is found depends neither on who does it nor on what came before.

    Parameters
    ----------
    objective : Objective
        It is sent to each worker once, so it does not change. Where it cannot be pickled, or a
        worker cannot read it, it judges here.
    rigs : sequence of Rig
    below : float
        Only entropies below this one are asked for [nats]; all, by default.
    executor : concurrent.futures.Executor, optional
        Whose workers judge; by default it is done here. `Processes` replaces a worker that died.

    Returns
    -------
    list of Judgement
        One a rig: its entropy where that is below `below`; otherwise `below` itself as a lower
        bound, whatever else is known.

    Raises
    ------
    InputError
        When workers died twice with the same rig, and whatever the objective raises.
    """
    if isinstance(objective, OfItself):
        return objective.judge_all(rigs, below, executor)
    if executor is not None and rigs:
        try:
            return handed_out(_assigned(objective, rigs, below), executor)
        except Unreadable:
            pass
    return [_settled(objective.judge(rig, below), below) for rig in rigs]


def _settled(found: Judgement, below: float) -> Judgement:
    """Leave out how an entropy that is not below was told: that depends on what was known."""
    return found if found.entropy < below else Judgement(below, True)


def _assigned(
    objective: Objective, rigs: Sequence[Rig], below: float
) -> list[Assignment[Judgement]]:
    try:
        sent, candidates = packed(objective), [Parcel(rig) for rig in rigs]
    except Exception as error:  # whatever a foreign class raises where it cannot be pickled
        raise Unreadable(str(error)) from None
    found = []
    for rig, candidate in zip(rigs, candidates, strict=True):
        parcels = {**candidate.inner, **sent.all}
        what = (sent.key, tuple(parcels), candidate.data, below)
        found.append(Assignment(_told(rig), _judge_there, what, parcels))
    return found


def _judge_there(
    data: Mapping[str, bytes], key: str, needed: Sequence[str], candidate: bytes, below: float
) -> Reply[Judgement]:
    """Judge a rig in a worker."""
    try:
        objective = unpacked(key, data, needed)
        rig = contents(candidate)
    except NotHere as missing:
        return Reply(missing=missing.keys)
    except Exception as error:  # a class that is not known here, or whatever it raises
        return Reply(error=Unreadable(str(error)))
    try:
        return Reply(_settled(objective.judge(rig, below), below))
    except Exception as error:
        return Reply(error=error)


def _told(rig: Rig) -> str:
    """Return a rig as messages tell it."""
    places = (f"{s.name} at {[round(w, 3) for w in s.pose.position]}" for s in rig)
    return ", ".join(places)
