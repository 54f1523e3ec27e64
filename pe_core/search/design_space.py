"""The designs that a selection allows, and the search for their Pareto front.

A design says which option each site takes. The front is that of price against entropy.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import le

from ..base.errors import InputError
from ..scene.rig import Rig, SensorModel
from .mounts import Mounting
from .selection import Selection, Site, sites_of

Picks = tuple[int, ...]
"""A design: the number of the option that each site takes."""
LIMITS: dict[str, object] = {"max_price": None, "max_sensors": None, "max_of_kind": {}}
"""Limits of a selection, and the value of each that means no limit."""
MAX_STEPS = 20_000
"""How many partial designs are tried in the search for designs within the limits."""
SLACK = 1e-9
"""Relative rounding error that is allowed for sums of prices."""


@dataclass(frozen=True)
class DesignSpace:
    """All designs that a selection allows for a rig.

    `others` is the number of sensors that are not chosen, by kind.
    """

    sites: tuple[Site, ...]
    selection: Selection
    others: Counter[str]

    @classmethod
    def of(cls, selection: Selection, rig: Rig, mounting: Mounting) -> DesignSpace:
        """Return the designs of a rig; `InputError` for an impossible choice, or none left."""
        sites = sites_of(selection, rig, mounting)
        chosen = {name for site in sites for name in site.sensors}
        others = Counter(sensor.kind for sensor in rig if sensor.name not in chosen)
        designs = cls(sites, selection, others)
        if sites and not designs.first(1):
            raise designs._excluded()
        return designs

    def __iter__(self) -> Iterator[Picks]:
        """Yield designs; sites of one choice take their options in ascending order.

        `InputError` after `MAX_STEPS` partial designs: the limits may allow one design in 1e40.
        """
        yield from self._completed((), itertools.count())

    def first(self, count: int) -> list[Picks]:
        """Return the first `count` designs, or all if there are fewer."""
        return list(itertools.islice(self, count))

    def price(self, picks: Iterable[int]) -> float:
        """Return the price of a design."""
        return sum(site.price(pick) for site, pick in zip(self.sites, picks, strict=False))

    def models(self, picks: Sequence[int]) -> dict[str, SensorModel | None]:
        """Return the model of each chosen sensor; None if it is left out."""
        models: dict[str, SensorModel | None] = {}
        for site, pick in zip(self.sites, picks, strict=True):
            option = site.options[pick]
            model = None if option is None else option.model
            models |= dict.fromkeys(site.sensors, model)
        return models

    def neighbours(self, picks: Picks) -> Iterator[Picks]:
        """Yield the neighbours of a design: one site takes another option."""
        for k, site in enumerate(self.sites):
            for pick in range(len(site.options)):
                other = self._ordered((*picks[:k], pick, *picks[k + 1 :]))
                if other != picks and self._has_sensor(other) and self._within_limits(other):
                    yield other

    def _ordered(self, picks: Picks) -> Picks:
        """Return a design with the options of the sites of one choice in order."""
        ordered = list(picks)
        for number in {site.choice for site in self.sites}:
            numbers = [k for k, site in enumerate(self.sites) if site.choice == number]
            for k, pick in zip(numbers, sorted(picks[k] for k in numbers), strict=True):
                ordered[k] = pick
        return tuple(ordered)

    def _completed(self, begun: Picks, steps: Iterator[int]) -> Iterator[Picks]:
        if not self._within_limits(begun):
            return
        if next(steps) >= MAX_STEPS:
            expected = f"limits that are checked on {MAX_STEPS:,} designs that are begun"
            raise InputError("selection", "choice", f"fewer choices, or {expected}", "more")
        if len(begun) == len(self.sites):
            if self._has_sensor(begun):
                yield begun
            return
        site, last = self.sites[len(begun)], len(begun) - 1
        same_choice = last >= 0 and self.sites[last].choice == site.choice
        for pick in range(begun[last] if same_choice else 0, len(site.options)):
            yield from self._completed((*begun, pick), steps)

    def _has_sensor(self, picks: Picks) -> bool:
        """Whether a design has a sensor."""
        return bool(self.others) or any(
            site.options[pick] is not None for site, pick in zip(self.sites, picks, strict=True)
        )

    def _within_limits(self, begun: Picks) -> bool:
        """Whether a partial design, completed with the cheapest options, is within the limits."""
        limits, rest = self.selection, self.sites[len(begun) :]
        kinds = Counter(self.others)
        for site, pick in zip(self.sites, begun, strict=False):
            if (option := site.options[pick]) is not None:
                kinds[option.model.kind] += len(site.sensors)
        sensors = kinds.total() + sum(len(s.sensors) for s in rest if None not in s.options)
        price = self.price(begun) + sum(_min_price(site) for site in rest)
        return (
            (limits.max_price is None or price <= limits.max_price * (1.0 + SLACK))
            and (limits.max_sensors is None or sensors <= limits.max_sensors)
            and all(kinds[kind] <= max_count for kind, max_count in limits.max_of_kind.items())
        )

    def _excluded(self) -> InputError:
        """Return the error that names a smallest set of limits that leaves no design."""
        names = [name for name, none in LIMITS.items() if getattr(self.selection, name) != none]
        for name in list(names):
            fewer = [other for other in names if other != name]
            if not self._limited_by(fewer).first(1):
                names = fewer
        if not names:
            return InputError("selection", "choice", "a design with a sensor", "none")
        least = ""
        if names == ["max_price"]:
            least = f"; the cheapest costs {sum(map(_min_price, self.sites)):g}"
        elif names == ["max_sensors"]:
            required = sum(len(site.sensors) for site in self.sites if None not in site.options)
            least = f"; the smallest has {max(self.others.total() + required, 1)} sensors"
        expected = "limits that leave a design"
        return InputError("selection", " and ".join(names), expected, f"none{least}")

    def _limited_by(self, names: Sequence[str]) -> DesignSpace:
        """Return the designs under the named limits only."""
        none = {name: value for name, value in LIMITS.items() if name not in names}
        return replace(self, selection=replace(self.selection, **none))  # type: ignore[arg-type]


def _min_price(site: Site) -> float:
    return min(site.price(pick) for pick in range(len(site.options)))


Worth = tuple[float, float]
"""A price and an entropy [nats]; lower is better for both."""
ALL_UP_TO = 200
"""Up to so many designs are all evaluated; of more, those that the local search visits."""
MAX_EVALUATED = 400
"""How many designs the local search evaluates at most."""


def pareto_front(costs: Sequence[Sequence[float]]) -> list[int]:
    """Return the indices of the non-dominated costs, lowest first; of equal ones the first.

    Costs dominate others if none of their values is higher and they are not equal.
    """
    front: list[int] = []
    for number in sorted(range(len(costs)), key=lambda k: (*costs[k], k)):
        own = costs[number]  # what dominates it comes before it
        if not any(all(map(le, costs[k], own)) for k in front):
            front.append(number)
    return front


def above_front(worths: Sequence[Worth]) -> list[float]:
    """Return how much higher each entropy is than the lowest at no higher price [nats]."""
    return [
        entropy - min(other for cost, other in worths if cost <= price) for price, entropy in worths
    ]


class DesignSearch:
    """The search for the Pareto front: all designs if they are few, else Pareto local search.

    The local search begins with the first design, and evaluates all neighbours of every design on
    the current front, until none is new (Paquete, Chiarandini and Stuetzle, 2004). It is
    deterministic. `is_complete` says whether all designs are evaluated, at most `max_designs`.
    """

    def __init__(self, designs: DesignSpace) -> None:
        self._designs = designs
        first = designs.first(ALL_UP_TO + 1)
        self.is_complete = len(first) <= ALL_UP_TO
        self._asked: set[Picks] = set()
        self._expanded: set[Picks] = set()
        self._next = first if self.is_complete else first[:1]
        self.max_designs = len(first) if self.is_complete else MAX_EVALUATED

    def ask(self) -> list[Picks]:
        """Return the designs to evaluate next; none when the search is over."""
        room = ALL_UP_TO if self.is_complete else MAX_EVALUATED - len(self._asked)
        batch = self._next[:room]
        self._asked.update(batch)
        return batch

    def tell(self, entropies: Mapping[Picks, float]) -> None:
        """Take the entropies of all designs that were evaluated so far [nats]."""
        self._next = [] if self.is_complete else list(self._new(entropies))

    def _new(self, entropies: Mapping[Picks, float]) -> Iterator[Picks]:
        evaluated, visited = list(entropies), set(self._asked)
        worths = [(self._designs.price(picks), entropies[picks]) for picks in evaluated]
        for number in pareto_front(worths):
            if evaluated[number] in self._expanded:
                continue
            self._expanded.add(evaluated[number])
            for picks in self._designs.neighbours(evaluated[number]):
                if picks not in visited:
                    visited.add(picks)
                    yield picks
