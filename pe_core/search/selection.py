"""Which sensors a study may choose: models with prices, limits, and the sites that take them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from ..base.arrays import ReadOnlyDict
from ..base.errors import InputError, shown
from ..base.setting import Panel, check_settings, required_setting, setting
from ..base.values import A_NAME, Name, Number, Whole, listed
from ..scene.rig import Rig, SensorModel
from .mounts import NO_MOUNT, Mounting

PRICE = Number(0.0, cap=1e12, noun="price")
COUNT = Whole(0, 10_000)
CURRENCY = Name("a currency", empty=True)


@dataclass(frozen=True, slots=True)
class Option:
    """A model that may be chosen, and the price of one sensor.

    Parameters
    ----------
    model : SensorModel
    price : float
        In the unit of the study: the catalogue has no prices.
    """

    model: SensorModel
    price: float = required_setting(
        PRICE,
        "Price of one sensor. The catalogue has no prices",
        Panel("price", "Price", soft_max=1e5, precision=2, step=1000),
    )

    def __post_init__(self) -> None:
        if not isinstance(self.model, SensorModel):
            raise InputError("option", "model", "the model of a sensor", shown(self.model))
        check_settings(self, "option")


@dataclass(frozen=True, slots=True)
class Choice:
    """Models of which some sensors take one.

    Parameters
    ----------
    options : sequence of Option
    sensors : sequence of str
        They take the same model, or are left out together. The second sensor of a pair is not
        named: it has the model of the first.
    mount : str, optional
        Instead of `sensors`: every sensor that starts on this mount takes a model of its own.
        Exchanging the models of two of them does not give another design.
    optional : bool
        Whether the sensors may be left out.

    Raises
    ------
    InputError
        When there are no options, a model is offered twice, or not exactly one of `sensors` and
        `mount` is given.
    """

    options: Sequence[Option]
    sensors: Sequence[str] = ()
    mount: str | None = None
    optional: bool = False

    def __post_init__(self) -> None:
        put, who = object.__setattr__, "choice"
        options, sensors = listed(self.options), listed(self.sensors)
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
    """All choices of a study, and the limits of every design.

    Parameters
    ----------
    choices : sequence of Choice
    max_price : float, optional
        Limit of a design's price: the sum over the chosen sensors.
    max_sensors : int, optional
        Limit of the number of sensors, including those that are not chosen.
    max_of_kind : mapping of kind to int
        The same for a kind ("lidar", "camera"); a kind that is not named has no limit.
    currency : str
        The currency of prices in texts.
    """

    choices: Sequence[Choice] = ()
    max_price: float | None = setting(
        None,
        PRICE,
        "Largest sum of the prices of all chosen sensors",
        Panel(
            "max_price",
            "Max Price",
            soft_max=1e6,
            zero="no limit",
            beside="No Limit",
            precision=2,
            step=1000,
        ),
    )
    max_sensors: int | None = setting(
        None,
        COUNT,
        "Largest number of sensors in a design",
        Panel("max_sensors", "Max Sensors", soft_max=20, zero="no limit", beside="No Limit"),
    )
    max_of_kind: Mapping[str, int] = field(default_factory=dict)
    currency: str = setting("", CURRENCY, "Currency of prices", Panel("currency", "Currency"))

    def __post_init__(self) -> None:
        put, who = object.__setattr__, "selection"
        choices = listed(self.choices)
        if choices is None or not all(isinstance(item, Choice) for item in choices):
            raise InputError(who, "choice", "a list of choices", shown(self.choices))
        put(self, "choices", tuple(choices))
        check_settings(self, who)
        if not isinstance(self.max_of_kind, Mapping):
            raise InputError(who, "max_of_kind", "numbers by kind", shown(self.max_of_kind))
        counts = {
            A_NAME.checked(who, "max_of_kind", kind): COUNT.checked(who, f"max_of_kind.{kind}", n)
            for kind, n in self.max_of_kind.items()
        }
        put(self, "max_of_kind", ReadOnlyDict(counts))


@dataclass(frozen=True, slots=True)
class Site:
    """Sensors that take one model, or are left out together.

    Options are sorted by price; None, the last, leaves the sensors out. Sites of one choice may
    exchange their options: it is the same design.
    """

    sensors: tuple[str, ...]
    options: tuple[Option | None, ...]
    choice: int

    def price(self, pick: int) -> float:
        """Return the price of an option for all sensors of the site."""
        option = self.options[pick]
        return 0.0 if option is None else option.price * len(self.sensors)


def sites_of(selection: Selection, rig: Rig, mounting: Mounting) -> tuple[Site, ...]:
    """Return the sites of a study, in the order of its choices.

    `InputError` when a choice has a sensor or a mount that does not exist, two choices have one
    sensor, a model's kind is not allowed, or a sensor that others follow could be left out.
    """
    sites: list[Site] = []
    for number, choice in enumerate(selection.choices):
        who, options = f"choice[{number}]", sorted(choice.options, key=lambda o: o.price)
        for option in choice.options:
            if selection.max_of_kind.get(kind := option.model.kind) == 0:
                expected = f"models of kinds that are allowed (max_of_kind of {kind!r} is 0)"
                raise InputError(who, "option", expected, f"{option.model.name}, a {kind}")
        for sensors in _sites_of_choice(who, choice, rig, mounting):
            for name in sensors:
                if any(name in site.sensors for site in sites):
                    expected, found = "one choice for each sensor", f"two for {name!r}"
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
        if name not in names:
            raise InputError(who, "sensor", f"one of {', '.join(names)}", shown(name))
    if choice.mount is None:
        yield _with_images(choice.sensors, mounting)
        return
    if choice.mount not in mounting.mounts:
        known = f"one of {', '.join(mounting.mounts)}" if mounting.mounts else NO_MOUNT
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
