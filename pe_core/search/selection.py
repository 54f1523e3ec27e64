"""Which sensors a study may have: choices with prices, and limits on all of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..errors import InputError, shown
from ..scene.sensors import SensorModel
from ..text.fixed import FixedDict
from ..text.values import A_NAME, Number, Whole, listed

PRICE = Number(0.0, cap=1e12, noun="price")
COUNT = Whole(0, 10_000)


@dataclass(frozen=True, slots=True)
class Option:
    """A model that may be chosen, and what one sensor of it costs.

    Parameters
    ----------
    model : SensorModel
    price : float
        In the study's own unit: the catalogue knows no prices.
    """

    model: SensorModel
    price: float

    def __post_init__(self) -> None:
        if not isinstance(self.model, SensorModel):
            raise InputError("option", "model", "the model of a sensor", shown(self.model))
        object.__setattr__(self, "price", PRICE.checked("option", "price", self.price))


@dataclass(frozen=True, slots=True)
class Choice:
    """Models of which sensors take one.

    Parameters
    ----------
    options : sequence of Option
    sensors : sequence of str
        They take the same model, or are left out together. The second of a pair goes with its
        first and is not named.
    mount : str, optional
        Instead of `sensors`: every sensor that starts on this mount takes a model of its own. Which
        of them takes which is no other design.
    optional : bool
        Whether the sensors may be left out.

    Raises
    ------
    InputError
        When there are no options, a model is offered twice, or not one of `sensors` and `mount`
        is said.
    """

    options: Sequence[Option]
    sensors: Sequence[str] = ()
    mount: str | None = None
    optional: bool = False

    def __post_init__(self) -> None:
        put, who = object.__setattr__, "choice"
        options, sensors = listed(self.options), listed(self.sensors)
        if not options or not all(isinstance(each, Option) for each in options):
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
    """All choices of a study, and what every design keeps to.

    Parameters
    ----------
    choices : sequence of Choice
    max_price : float, optional
        Of a design: the sum over the sensors that are chosen.
    max_sensors : int, optional
        Sensors of a design, those that nobody chooses included.
    max_of_kind : mapping of kind to int
        Likewise of a kind ("lidar", "camera"); one that is not named has no limit.
    currency : str
        What prices are told in.
    """

    choices: Sequence[Choice] = ()
    max_price: float | None = None
    max_sensors: int | None = None
    max_of_kind: Mapping[str, int] = field(default_factory=dict)
    currency: str = ""

    def __post_init__(self) -> None:
        put, who = object.__setattr__, "selection"
        choices = listed(self.choices)
        if choices is None or not all(isinstance(each, Choice) for each in choices):
            raise InputError(who, "choice", "a list of choices", shown(self.choices))
        put(self, "choices", tuple(choices))
        if self.max_price is not None:
            put(self, "max_price", PRICE.checked(who, "max_price", self.max_price))
        if self.max_sensors is not None:
            put(self, "max_sensors", COUNT.checked(who, "max_sensors", self.max_sensors))
        if not isinstance(self.max_of_kind, Mapping):
            raise InputError(who, "max_of_kind", "numbers by kind", shown(self.max_of_kind))
        counts = {
            A_NAME.checked(who, "max_of_kind", kind): COUNT.checked(who, f"max_of_kind.{kind}", n)
            for kind, n in self.max_of_kind.items()
        }
        put(self, "max_of_kind", FixedDict(counts))
        if self.currency != "":
            put(self, "currency", A_NAME.checked(who, "currency", self.currency))
