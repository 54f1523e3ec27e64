"""A rig as a vector of unknowns: what searches change, and what it means.

Nothing else knows how a vector becomes a rig: a search draws a vector, `candidate` makes it a
placement, and `allowed` says whether that may be scored.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from ..scene.geometry import Pose
from ..scene.sensors import Rig, Sensor
from .domains import Domain, InBox, InSlots, OnSurface
from .mounts import SlotMount, SurfaceMount
from .rules import Rule, Trial, rules_of
from .search_space import SearchSpace
from .surface import Skin
from .ties import followers
from .unknown import Unknown

Vector = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Candidate:
    """A placement, and the vector that stands for it."""

    rig: Rig
    vector: Vector


class Coding:
    """The unknowns of a search, and what they mean.

    Parameters
    ----------
    rig : Rig
        Where the search starts.
    space : SearchSpace

    Attributes
    ----------
    unknowns : tuple of Unknown
        In the rig's order of sensors; of sensors that follow others there are none.
    blocks : tuple of range
        Where in the vector the unknowns of one sensor are, of each that has some.
    start : Candidate
        The rig as it is.
    rules : tuple of Rule
        What every placement keeps to.

    Raises
    ------
    InputError
        When a sensor, a part or a mount is none, a start is outside its bounds or its mount, or a
        pair or a group is impossible.
    """

    unknowns: tuple[Unknown, ...]
    blocks: tuple[range, ...]
    start: Candidate
    rules: tuple[Rule, ...]

    def __init__(self, rig: Rig, space: SearchSpace) -> None:
        self.space = space.checked(rig)
        self._followers = followers(rig, space.mounting, space.vehicle)
        follow = {tie.name for tie in self._followers}
        self._domains = _domains(rig, space, follow)
        self.unknowns = tuple(u for domain in self._domains.values() for u in domain.unknowns)
        self.blocks = tuple(_blocks(self._domains.values()))
        vector = tuple(value for domain in self._domains.values() for value in domain.start)
        self.start = Candidate(rig, vector)
        self.rules = rules_of(rig, space, self._moving(), self._clear(), self._domains)

    def candidate(self, vector: Sequence[float]) -> Candidate:
        """Return the placement that a vector of (N,) unknowns stands for.

        Its own vector is the given one after rounding, and after the way down to a surface.
        """
        poses, held, at = dict[str, Pose](), list[float](), 0
        for name, domain in self._domains.items():
            count = len(domain.unknowns)
            poses[name], own = domain.placed(vector[at : at + count])
            held += own
            at += count
        for tie in self._followers:
            poses[tie.name] = tie.pose(poses[tie.leader])
        rig = self.start.rig
        return Candidate(rig.with_poses([poses[sensor.name] for sensor in rig]), tuple(held))

    def allowed(self, rig: Rig) -> bool:
        """Whether a placement keeps to all rules."""
        trial = Trial(rig, self.space)
        return not any(rule.broken(trial) for rule in self.rules)

    def broken(self, rig: Rig) -> frozenset[str]:
        """Return all rules that a placement breaks, in words."""
        trial = Trial(rig, self.space)
        return frozenset(rule.words for rule in self.rules if rule.broken(trial))

    def _moving(self) -> set[str]:
        """Names of the sensors that the search moves."""
        return self._led({name for name, domain in self._domains.items() if domain.unknowns})

    def _clear(self) -> set[str]:
        """Names of the sensors whose housings are kept clear: always of those on a surface."""
        if self.space.mounting.constraints.clear_housings:
            return {sensor.name for sensor in self.start.rig}
        return self._led(
            {n for n, domain in self._domains.items() if isinstance(domain, OnSurface)}
        )

    def _led(self, names: set[str]) -> set[str]:
        """Return sensors' names with those of all that follow them."""
        for tie in self._followers:
            names |= {tie.name} if tie.leader in names else set()
        return names


def _domains(rig: Rig, space: SearchSpace, follow: set[str]) -> dict[str, Domain]:
    """Return what the unknowns of each sensor mean that follows no other."""
    skins: dict[str, Skin] = {}
    return {s.name: _domain(s, space, skins) for s in rig if s.name not in follow}


def _blocks(domains: Iterable[Domain]) -> Iterator[range]:
    """Yield where in the vector the unknowns of each domain are that has some."""
    at = 0
    for domain in domains:
        count = len(domain.unknowns)
        if count:
            yield range(at, at + count)
        at += count


def _domain(sensor: Sensor, space: SearchSpace, skins: dict[str, Skin]) -> Domain:
    mounting, name = space.mounting, sensor.name
    mount, bounds = mounting.mount_of(name), space.bounds.get(name, {})
    who = f"sensor {name!r}"
    if isinstance(mount, SlotMount):
        return InSlots(who, mount, sensor.pose)
    if isinstance(mount, SurfaceMount):
        key = mounting.on[name]
        if key not in skins:
            skins[key] = Skin(f"mount {key!r}", mount, space.vehicle)
        return OnSurface(who, mount, skins[key], sensor.pose, space.housings.get(name), bounds)
    return InBox(sensor.pose, bounds)
