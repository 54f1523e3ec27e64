"""Which sensors a study may choose: models with prices, limits, and the sites that take them.

A design says which option each site takes. The front is that of price against entropy.
"""

import itertools
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from operator import le
from typing import Annotated, Any

from ..base.arrays import ReadOnlyDict
from ..base.errors import InputError, one_of, require_name, shown
from ..base.setting import Panel, Part, check_settings, required_setting, same_setting, setting
from ..base.values import A_NAME, Name, Whole, listed
from ..scene.data_sheet import PRICE, DataSheet
from ..scene.rig import Rig, Sensor, SensorModel
from ..sensors import KINDS
from .build_figures import BUILD_FIGURES, RELATIVE, SUMS, sheet_of
from .limit import FigureLimits
from .mounts import NO_MOUNT, Mounting
from .objective import Value
from .placement import Placement

COUNT = Whole(0, 10_000)
CURRENCY = Name("a currency", empty=True)
Picks = tuple[int, ...]
"""A design: the number of the option that each site takes."""
COUNTED = "max_sensors"
OF_KIND = "max_of_kind"
PRICE_SUM = "price"
"""Limits of numbers of sensors; the others are of sums, as `SUMS`."""
MAX_STEPS = 20_000
"""How many partial designs are tried in the search for designs within the limits."""
ALL_UP_TO = 200
"""Up to so many designs are all evaluated; of more, those that the local search visits."""
MAX_EVALUATED = 400  # How many designs the local search evaluates at most


@dataclass(frozen=True, slots=True)
class Option:
    """A model that may be chosen, the price of one sensor, and other figures of its data sheet.

    Parameters
    ----------
    price : float
        In the unit of the study: the catalogue has no prices.
    mass, power, data_rate : float, optional
        As of `DataSheet`.
    """

    model: SensorModel
    price: float = required_setting(
        PRICE,
        "Price of one sensor. The catalogue has no prices",
        Panel("price", "Price", soft_max=1e5, precision=2, step=1000),
    )
    mass: float | None = same_setting(DataSheet, "mass")
    power: float | None = same_setting(DataSheet, "power")
    data_rate: float | None = same_setting(DataSheet, "data_rate")

    def __post_init__(self) -> None:
        if not isinstance(self.model, SensorModel):
            raise InputError("option", "model", "the model of a sensor", shown(self.model))
        check_settings(self, "option")

    @property
    def sheet(self) -> DataSheet:
        """What is known of one such sensor, without the catalogue."""
        return DataSheet(self.mass, self.power, self.data_rate, self.price)


@dataclass(frozen=True, slots=True)
class Choice:
    """Models of which some sensors take one.

    `InputError` when there are no options, a model is offered twice, or not exactly one of
    `sensors` and `mount` is given.

    Parameters
    ----------
    sensors : sequence of str
        They take the same model, or are left out together. The second sensor of a pair is not
        named: it has the model of the first.
    mount : str, optional
        Instead of `sensors`: every sensor that starts on this mount takes a model of its own.
        Exchanging the models of two of them does not give another design.
    optional : bool
        Whether the sensors may be left out.
    """

    options: Annotated[Sequence[Option], Part(key="option")]
    sensors: Sequence[str] = ()
    mount: str | None = None
    optional: bool = False

    def __post_init__(self) -> None:
        put = object.__setattr__
        who = "choice"
        options = listed(self.options)
        sensors = listed(self.sensors)
        if not options or not all(isinstance(item, Option) for item in options):
            raise InputError(who, "option", "at least one model with its price", "none")
        models = [option.model.name for option in options]
        if twice := sorted({name for name in models if models.count(name) > 1}):
            raise InputError(who, "option", "each model once", f"{twice[0]!r} twice")
        if sensors is None or bool(sensors) == (self.mount is not None):
            found = "both" if sensors else "neither"
            raise InputError(who, "sensor, mount", "one of the two", found)
        put(self, "options", tuple(options))
        put(self, "sensors", tuple(A_NAME.checked(who, "sensor", name) for name in sensors))
        if self.mount is not None:
            put(self, "mount", A_NAME.checked(who, "mount", self.mount))
        if not isinstance(self.optional, bool):
            raise InputError(who, "optional", "true or false", shown(self.optional))


@dataclass(frozen=True, slots=True)
class Selection:
    """All choices of a study, and the limits of every design, as its fields say.

    `max_of_kind` limits the number of sensors of a kind ("lidar", "camera"), including those
    that are not chosen; a kind that is not named has no limit.
    """

    choices: Annotated[Sequence[Choice], Part(key="choice")] = ()
    max_sensors: int | None = setting(
        None,
        COUNT,
        "Largest number of sensors in a design",
        Panel("max_sensors", "Max Sensors", soft_max=20, zero="no limit", beside="No Limit"),
    )
    max_of_kind: Mapping[str, int] = field(default_factory=dict)
    currency: str = setting("", CURRENCY, "Currency of prices", Panel("currency", "Currency"))

    def __post_init__(self) -> None:
        put = object.__setattr__
        who = "selection"
        choices = listed(self.choices)
        if choices is None or not all(isinstance(item, Choice) for item in choices):
            raise InputError(who, "choice", "a list of choices", shown(self.choices))
        put(self, "choices", tuple(choices))
        check_settings(self, who)
        if not isinstance(self.max_of_kind, Mapping):
            raise InputError(who, "max_of_kind", "numbers by kind", shown(self.max_of_kind))
        for kind in self.max_of_kind:
            if kind not in KINDS:
                expected = one_of(KINDS, kind)
                raise InputError(who, f"max_of_kind.{kind}", expected, "an unknown key")
        counts = {
            A_NAME.checked(who, "max_of_kind", kind): COUNT.checked(who, f"max_of_kind.{kind}", n)
            for kind, n in self.max_of_kind.items()
        }
        put(self, "max_of_kind", ReadOnlyDict(counts))


@dataclass(frozen=True, slots=True)
class Site:
    """Sensors that take one model, or are left out together. Options are sorted by price; None, the
    last, leaves the sensors out. Sites of one choice may exchange their options: it is the same
    design."""

    sensors: tuple[str, ...]
    options: tuple[Option | None, ...]
    choice: int

    def sum(self, key: str, pick: int) -> float:
        """Return a sum, one of `SUMS`, of an option for all sensors of the site."""
        option = self.options[pick]
        if option is None:
            return 0.0
        return float(getattr(sheet_of(option.model, option.sheet), key)) * len(self.sensors)

    def least(self, key: str) -> float:
        """Return the least such sum of all options."""
        return min(self.sum(key, pick) for pick in range(len(self.options)))


def sites_of(selection: Selection, rig: Rig, mounting: Mounting) -> tuple[Site, ...]:
    """Return the sites of a study, in the order of its choices. `InputError` when a choice has a
    sensor or a mount that does not exist, two choices have one sensor, a model's kind is not
    allowed, or a sensor that others follow could be left out."""
    sites: list[Site] = []
    for number, choice in enumerate(selection.choices):
        who = f"choice[{number}]"
        options = sorted(choice.options, key=lambda o: o.price)
        for option in choice.options:
            if selection.max_of_kind.get(kind := option.model.kind) == 0:
                expected = f"models of kinds that are allowed (max_of_kind of {kind!r} is 0)"
                raise InputError(who, "option", expected, f"{option.model.name}, a {kind}")
        for sensors in _sites_of_choice(who, choice, rig, mounting):
            for name in sensors:
                if any(name in site.sensors for site in sites):
                    expected = "one choice for each sensor"
                    found = f"two for {name!r}"
                    raise InputError(who, "sensor", expected, found)
                if choice.optional and any(name == group[0] for group in mounting.groups):
                    expected = "false for the leading sensor of a group"
                    raise InputError(who, "optional", expected, f"true for {name!r}")
            left_out = (None,) if choice.optional else ()
            sites.append(Site(sensors, (*options, *left_out), number))
    return tuple(sites)


def _sites_of_choice(
    who: str, choice: Choice, rig: Rig, mounting: Mounting
) -> Iterator[tuple[str, ...]]:
    """Yield the sensors of each site of a choice, with their mirror images."""
    names = [sensor.name for sensor in rig]
    for name in choice.sensors:
        require_name(who, "sensor", name, names)
    if choice.mount is None:
        yield _with_images(choice.sensors, mounting)
        return
    if choice.mount not in mounting.mounts:
        known = one_of(mounting.mounts, choice.mount) if mounting.mounts else NO_MOUNT
        raise InputError(who, "mount", known, shown(choice.mount))
    on_mount = [name for name in names if mounting.on.get(name) == choice.mount]
    if not on_mount:
        expected = "a mount with sensors on it"
        raise InputError(who, "mount", expected, f"none on {choice.mount!r}")
    yield from (_with_images((name,), mounting) for name in on_mount)


def _with_images(names: Sequence[str], mounting: Mounting) -> tuple[str, ...]:
    """Return sensors with their mirror images."""
    taken = list(names)
    for first, second in mounting.pairs:
        if second in taken and first not in taken:
            expected = f"the first of the pair, {first!r}, which it goes with"
            raise InputError("choice", "sensor", expected, shown(second))
        if first in taken and second not in taken:
            taken.append(second)
    return tuple(dict.fromkeys(taken))


@dataclass(frozen=True)
class DesignSpace:
    """All designs that a selection allows for a rig. `others` are the sensors that are not chosen,
    `limits` the limits of a design by name."""

    sites: tuple[Site, ...]
    limits: Mapping[str, Any]
    others: tuple[Sensor, ...]

    @classmethod
    def of(
        cls, selection: Selection, rig: Rig, mounting: Mounting, limits: FigureLimits | None = None
    ) -> "DesignSpace":
        """Return the designs of a rig; `InputError` for an impossible choice, or none left."""
        sites = sites_of(selection, rig, mounting)
        chosen = {name for site in sites for name in site.sensors}
        others = tuple(sensor for sensor in rig if sensor.name not in chosen)
        kept = limits or FigureLimits()
        sums = {key: kept.kept_value(key) for key in SUMS}
        given: dict[str, Any] = {PRICE_SUM: sums.pop(PRICE_SUM)}
        given |= {name: getattr(selection, name) for name in (COUNTED, OF_KIND)}
        given |= sums
        design_limits = {name: value for name, value in given.items() if value not in (None, {})}
        designs = cls(sites, design_limits, others)
        designs.require(design_limits)
        if sites and not designs.first(1):
            raise designs._excluded()
        return designs

    def require(self, names: Collection[str]) -> None:
        """Raise `InputError` where one of some sums is not known for each sensor or option."""
        options = (each for site in self.sites for each in site.options if each)
        models = (Sensor(each.model.name, each.model, sheet=each.sheet) for each in options)
        offered = Placement((*self.others, *models))  # type: ignore[arg-type]  # not one rig
        for key in (name for name in SUMS if name in names and name != PRICE_SUM):
            BUILD_FIGURES[key].required(offered, "limits", key)

    def __iter__(self) -> Iterator[Picks]:
        """Yield designs; sites of one choice take their options in ascending order. `InputError`
        after `MAX_STEPS` partial designs: the limits may allow one design in 1e40."""
        yield from self._completed((), itertools.count())

    def first(self, count: int) -> list[Picks]:
        """Return the first `count` designs, or all if there are fewer."""
        return list(itertools.islice(self, count))

    def price(self, picks: Iterable[int]) -> float:
        """Return the price of a design; sensors without a choice and a price are free."""
        return self.sum("price", picks)

    def sum(self, key: str, picks: Iterable[int]) -> float:
        """Return a sum, one of `SUMS`, over a design or the first sites of one."""
        own = (getattr(sheet_of(s.model, s.sheet), key) or 0.0 for s in self.others)
        sites = zip(self.sites, picks, strict=False)
        return sum(site.sum(key, pick) for site, pick in sites) + sum(own)

    def models(self, picks: Sequence[int]) -> dict[str, SensorModel | None]:
        """Return the model of each chosen sensor; None if it is left out."""
        models: dict[str, SensorModel | None] = {}
        for site, pick in zip(self.sites, picks, strict=True):
            option = site.options[pick]
            model = None if option is None else option.model
            models |= dict.fromkeys(site.sensors, model)
        return models

    def sheets(self, picks: Sequence[int]) -> dict[str, DataSheet]:
        """Return what is known of each chosen sensor, without the catalogue."""
        options = ((site, site.options[pick]) for site, pick in zip(self.sites, picks, strict=True))
        return {n: option.sheet for site, option in options if option for n in site.sensors}

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
        site = self.sites[len(begun)]
        last = len(begun) - 1
        same_choice = last >= 0 and self.sites[last].choice == site.choice
        for pick in range(begun[last] if same_choice else 0, len(site.options)):
            yield from self._completed((*begun, pick), steps)

    def _has_sensor(self, picks: Picks) -> bool:
        """Whether a design has a sensor."""
        return bool(self.others) or any(
            site.options[pick] is not None for site, pick in zip(self.sites, picks, strict=True)
        )

    def _within_limits(self, begun: Picks) -> bool:
        """Whether a partial design, completed with the least options, is within the limits."""
        kinds = Counter(sensor.kind for sensor in self.others)
        for site, pick in zip(self.sites, begun, strict=False):
            if (option := site.options[pick]) is not None:
                kinds[option.model.kind] += len(site.sensors)
        totals = ((name, limit) for name, limit in self.limits.items() if name != OF_KIND)
        return all(
            self._least(name, begun, kinds.total()) <= limit * (1.0 + RELATIVE)
            for name, limit in totals
        ) and all(kinds[kind] <= count for kind, count in self.limits.get(OF_KIND, {}).items())

    def _least(self, name: str, begun: Picks, count: int) -> float:
        """Return what a limit limits, of a begun design with `count` sensors, or less."""
        rest = self.sites[len(begun) :]
        if name == COUNTED:
            return count + sum(len(s.sensors) for s in rest if None not in s.options)
        return self.sum(name, begun) + sum(site.least(name) for site in rest)

    def _excluded(self) -> InputError:
        """Return the error that names a smallest set of limits that leaves no design."""
        names = list(self.limits)
        for name in list(names):
            fewer = [other for other in names if other != name]
            limits = {other: self.limits[other] for other in fewer}
            if not replace(self, limits=limits).first(1):
                names = fewer
        if not names:
            return InputError("selection", "choice", "a design with a sensor", "none")
        least = ""
        if len(names) == 1 and names != [OF_KIND]:
            least = f"; the least possible is {self._least(names[0], (), len(self.others)):g}"
        expected = "limits that leave a design"
        return InputError("selection", " and ".join(names), expected, f"none{least}")


def pareto_front(costs: Sequence[Sequence[float | Value]]) -> list[int]:
    """Return the indices of the non-dominated costs, lowest first; of equal ones the first. Costs
    dominate others if none of their values is higher and they are not equal."""
    front: list[int] = []
    for number in sorted(range(len(costs)), key=lambda k: (*costs[k], k)):
        own = costs[number]  # what dominates it comes before it
        if not any(all(map(le, costs[k], own)) for k in front):
            front.append(number)
    return front


def above_front(worths: Sequence[tuple[float, Value]]) -> list[float]:
    """Return how much higher each value is than the lowest at no higher price."""
    return [
        value.rise_from(min(other for cost, other in worths if cost <= price))
        for price, value in worths
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

    def tell(self, values: Mapping[Picks, Value]) -> None:
        """Take the values of all designs that were evaluated so far."""
        self._next = [] if self.is_complete else list(self._new(values))

    def _new(self, values: Mapping[Picks, Value]) -> Iterator[Picks]:
        evaluated = list(values)
        visited = set(self._asked)
        worths = [(self._designs.price(picks), values[picks]) for picks in evaluated]
        for number in pareto_front(worths):
            if evaluated[number] in self._expanded:
                continue
            self._expanded.add(evaluated[number])
            for picks in self._designs.neighbours(evaluated[number]):
                if picks not in visited:
                    visited.add(picks)
                    yield picks
