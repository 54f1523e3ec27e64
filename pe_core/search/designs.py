"""DesignSpace: what each site of a study takes; which of them the limits allow."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from ..errors import InputError
from ..scene.sensors import Rig, SensorModel
from .mounts import Mounting
from .selection import Selection
from .sites import Site, sites_of

Picks = tuple[int, ...]
"""A design: which option each site takes."""
LIMITS: dict[str, object] = {"max_price": None, "max_sensors": None, "max_of_kind": {}}
"""Limits of a selection, and what each is where there is none."""
MAX_STEPS = 20_000
"""Designs that are begun while those that the limits allow are looked for."""
SLACK = 1e-9
"""Sums of prices are as large as a limit to this share of it."""


@dataclass(frozen=True)
class DesignSpace:
    """All designs that a selection allows for a rig.

    Attributes
    ----------
    sites : tuple of Site
    selection : Selection
    others : Counter of str
        Sensors that nobody chooses, by kind.
    """

    sites: tuple[Site, ...]
    selection: Selection
    others: Counter[str]

    @classmethod
    def of(cls, selection: Selection, rig: Rig, mounting: Mounting) -> DesignSpace:
        """Return the designs of a rig.

        Raises
        ------
        InputError
            When a choice is impossible, or no design keeps to the limits.
        """
        sites = sites_of(selection, rig, mounting)
        chosen = {name for site in sites for name in site.sensors}
        others = Counter(sensor.kind for sensor in rig if sensor.name not in chosen)
        designs = cls(sites, selection, others)
        if sites and not designs.first(1):
            raise designs._excluded()
        return designs

    def __iter__(self) -> Iterator[Picks]:
        """Yield designs; sites that are alike take their options in order.

        Raises
        ------
        InputError
            After `MAX_STEPS` designs that were begun: limits may leave one in 1e40.
        """
        yield from self._from((), itertools.count())

    def first(self, count: int) -> list[Picks]:
        """Return so many designs, or all where there are fewer."""
        return list(itertools.islice(self, count))

    def price(self, picks: Iterable[int]) -> float:
        """What a design costs."""
        return sum(site.price(pick) for site, pick in zip(self.sites, picks, strict=False))

    def models(self, picks: Sequence[int]) -> dict[str, SensorModel | None]:
        """Return the model of each sensor that somebody chooses; None where it is left out."""
        found: dict[str, SensorModel | None] = {}
        for site, pick in zip(self.sites, picks, strict=True):
            option = site.options[pick]
            model = None if option is None else option.model
            found |= dict.fromkeys(site.sensors, model)
        return found

    def neighbours(self, picks: Picks) -> Iterator[Picks]:
        """Yield designs that are one step away: a site takes something else, or two swap it."""
        for k, site in enumerate(self.sites):
            for pick in range(len(site.options)):
                yield from self._if_allowed((*picks[:k], pick, *picks[k + 1 :]), picks)

    def _if_allowed(self, picks: Picks, other_than: Picks) -> Iterator[Picks]:
        ordered = self._ordered(picks)
        if ordered != other_than and self._counts(ordered) and self._keeps(ordered):
            yield ordered

    def _ordered(self, picks: Picks) -> Picks:
        """Return a design with the options of sites that are alike in order."""
        ordered = list(picks)
        for number in {site.alike for site in self.sites}:
            places = [k for k, site in enumerate(self.sites) if site.alike == number]
            for k, pick in zip(places, sorted(picks[k] for k in places), strict=True):
                ordered[k] = pick
        return tuple(ordered)

    def _from(self, begun: Picks, steps: Iterator[int]) -> Iterator[Picks]:
        if not self._keeps(begun):
            return
        if next(steps) >= MAX_STEPS:
            expected = f"limits that are checked on {MAX_STEPS:,} designs that are begun"
            raise InputError("selection", "choice", f"fewer choices, or {expected}", "more")
        if len(begun) == len(self.sites):
            if self._counts(begun):
                yield begun
            return
        site, last = self.sites[len(begun)], len(begun) - 1
        alike = last >= 0 and self.sites[last].alike == site.alike
        for pick in range(begun[last] if alike else 0, len(site.options)):
            yield from self._from((*begun, pick), steps)

    def _counts(self, picks: Picks) -> bool:
        """Whether a design has a sensor."""
        return bool(self.others) or any(
            site.options[pick] is not None for site, pick in zip(self.sites, picks, strict=True)
        )

    def _keeps(self, begun: Picks) -> bool:
        """Whether what is picked so far, and the least of the rest, keeps to the limits."""
        limits, rest = self.selection, self.sites[len(begun) :]
        kinds = Counter(self.others)
        for site, pick in zip(self.sites, begun, strict=False):
            if (option := site.options[pick]) is not None:
                kinds[option.model.kind] += len(site.sensors)
        sensors = kinds.total() + sum(len(s.sensors) for s in rest if None not in s.options)
        price = self.price(begun) + sum(_least(site) for site in rest)
        return (
            (limits.max_price is None or price <= limits.max_price * (1.0 + SLACK))
            and (limits.max_sensors is None or sensors <= limits.max_sensors)
            and all(kinds[kind] <= most for kind, most in limits.max_of_kind.items())
        )

    def _excluded(self) -> InputError:
        """Return the error that names a smallest set of limits that leaves no design."""
        names = [name for name, none in LIMITS.items() if getattr(self.selection, name) != none]
        for name in list(names):
            fewer = [other for other in names if other != name]
            if not self._under(fewer).first(1):
                names = fewer
        if not names:
            return InputError("selection", "choice", "a design with a sensor", "none")
        field, expected = " and ".join(names), "limits that leave a design"
        return InputError("selection", field, expected, f"none{self._least_words(names)}")

    def _least_words(self, names: Sequence[str]) -> str:
        """Return what a design needs at least, where one limit alone leaves none."""
        if names == ["max_price"]:
            return f"; the cheapest costs {sum(map(_least, self.sites)):g}"
        if names == ["max_sensors"]:
            kept = sum(len(site.sensors) for site in self.sites if None not in site.options)
            return f"; the smallest has {max(self.others.total() + kept, 1)} sensors"
        return ""

    def _under(self, names: Sequence[str]) -> DesignSpace:
        """Return the designs under some of the limits alone."""
        none = {name: value for name, value in LIMITS.items() if name not in names}
        return replace(self, selection=replace(self.selection, **none))  # type: ignore[arg-type]


def _least(site: Site) -> float:
    return min(site.price(pick) for pick in range(len(site.options)))
